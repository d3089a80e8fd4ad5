//! A board's lines, whole, cut and in noise.

use super::schedule::IDENTIFY_MS;
use super::*;
use proptest::prelude::*;
use shared::myo::{Address, Following, Imu};
use shared::stream::safe_state::{Cause, Status};
use shared::uart_line::answer::Binding;
use shared::uart_line::calibration::CalibrateCommand;
use shared::uart_line::command::{AlignCommand, BindCommand};
use shared::uart_line::imu::ImuReport;
use shared::uart_line::{Counters, Report, ReportKind};
use shared::units::Sample;

fn report(sequence: u32) -> String {
    Report {
        kind: ReportKind::State,
        sequence,
        instant: SampleIndex(0),
        emitted: SampleIndex(0),
        status: Status::Safe(Cause::Boot),
        counters: Counters::default(),
        strength: None,
    }
    .to_string()
}

fn emg(first: u32) -> String {
    let sample: Sample = [first as i8; 8];
    EmgReport {
        first: SampleIndex(first),
        samples: [sample; 2],
    }
    .to_string()
}

fn dialogue() -> Dialogue {
    Dialogue::new(Millis(0), Losses::default(), false)
}

fn events(dialogue: &mut Dialogue, text: &[u8]) -> Vec<BoardEvent> {
    let mut all = Vec::new();
    dialogue.bytes(Millis(0), 0.0, text, |event| all.push(event));
    all
}

/// Number of samples missing before each notification that was heard.
fn missing(dialogue: &mut Dialogue, lines: &[String]) -> Vec<Option<u32>> {
    let events = events(dialogue, lines.concat().as_bytes());
    let missing = events.into_iter().filter_map(|event| match event {
        BoardEvent::Samples(_, missing) => Some(missing),
        _ => None,
    });
    missing.collect()
}

#[test]
fn lost_samples_and_lines_are_counted() {
    let mut dialogue = dialogue();
    let lines = [emg(100), emg(102), emg(110), report(5), report(8)];
    let found = missing(&mut dialogue, &lines);
    assert_eq!(found, [None, Some(0), Some(6)]);
    let damaged = emg(112).replacen("70", "71", 1);
    assert_eq!(missing(&mut dialogue, &[damaged, emg(114)]), [Some(2)]);
    let expected = Losses {
        damaged: 1,
        missing: 2,
        samples: 8,
    };
    assert_eq!(dialogue.state.losses, expected);
}

#[test]
fn a_restarted_board_begins_another_stream_and_nothing_is_missing() {
    let mut dialogue = dialogue();
    let lines = [report(70_000), emg(9_000), report(0), emg(0), emg(2)];
    let found = events(&mut dialogue, lines.concat().as_bytes());
    assert!(found.contains(&BoardEvent::Restart));
    assert_eq!(dialogue.state.losses, Losses::default());
    // The stream counts as new even if the line of its start is lost.
    assert_eq!(missing(&mut dialogue, &[emg(0)]), [None]);
}

#[test]
fn numbers_go_on_over_their_wrap() {
    let mut dialogue = dialogue();
    let lines = [report(u32::MAX), report(0), emg(u32::MAX - 1), emg(0)];
    assert_eq!(missing(&mut dialogue, &lines), [None, Some(0)]);
    assert_eq!(dialogue.state.losses, Losses::default());
}

#[test]
fn the_board_is_asked_in_turn_and_for_samples_again_while_none_come() {
    let mut dialogue = dialogue();
    let mut commands = Vec::new();
    for now in 0..4_000 {
        while let Some(command) = dialogue.command(Millis(now)) {
            commands.push((now, command));
        }
        // Samples come from 1.5 to 2.5 s.
        if (1_500..2_500).contains(&now) && now % 10 == 0 {
            dialogue.bytes(Millis(now), 0.0, emg(now / 5).as_bytes(), |_| {});
        }
    }
    let expected = [
        (0, Command::Identify),
        (0, Command::Align(AlignCommand::State)),
        (0, Command::Bind(BindCommand::State)),
        (0, Command::Calibrate(CalibrateCommand::State)),
        (0, Command::Raw(true)),
        (0, Command::Counters),
        (1_000, Command::Raw(true)),
        (2_000, Command::Counters),
        (3_490, Command::Raw(true)),
    ];
    assert_eq!(commands, expected);
    let later = dialogue.command(Millis(IDENTIFY_MS));
    assert_eq!(later, Some(Command::Identify));
}

#[test]
fn an_alignment_that_was_made_before_is_told_once_and_asked_for_again_after_a_restart() {
    let mut dialogue = dialogue();
    let alignment = Alignment::new(3, false);
    let answer = Answer::Alignment(alignment).to_string();
    let answer = answer.as_bytes();
    let expected = [
        BoardEvent::Alignment(alignment),
        BoardEvent::Publish(Event::of_placement(0.0, alignment)),
    ];
    let found = |dialogue: &mut Dialogue| {
        let mut all = events(dialogue, answer);
        all.retain(|event| !matches!(event, BoardEvent::Publish(Event::Line { .. })));
        all
    };
    assert_eq!(found(&mut dialogue), expected);
    assert_eq!(found(&mut dialogue), []);
    while dialogue.command(Millis(0)).is_some() {}
    events(&mut dialogue, [report(7), report(0)].concat().as_bytes());
    let next = dialogue.command(Millis(1));
    assert_eq!(next, Some(Command::Align(AlignCommand::State)));
    assert_eq!(found(&mut dialogue), expected);
}

#[test]
fn a_board_that_follows_nobody_is_asked_every_second_and_a_bound_one_seldom() {
    let mut dialogue = dialogue();
    let mut commands = |following: Following, from: u32| {
        let binding = Binding {
            following,
            is_kept: true,
        };
        let published = events(
            &mut dialogue,
            Answer::Binding(binding).to_string().as_bytes(),
        );
        assert!(
            published.contains(&BoardEvent::Publish(Event::of_binding(&binding))),
            "{published:?}"
        );
        let mut times = Vec::new();
        for now in from..from + 5_000 {
            while let Some(command) = dialogue.command(Millis(now)) {
                if command == Command::Bind(BindCommand::State) {
                    times.push(now);
                }
            }
        }
        times
    };
    assert_eq!(
        commands(Following::Nobody, 0),
        [0, 1_000, 2_000, 3_000, 4_000]
    );
    assert_eq!(commands(Following::Pairing, 5_000).len(), 5);
    let armband = Address::parse("FA:12:34:56:78:9A").unwrap();
    assert!(commands(Following::Bound(armband), 10_000).is_empty());
}

#[test]
fn five_seconds_without_a_line_are_a_silence() {
    let mut dialogue = dialogue();
    assert!(!dialogue.is_silent(Millis(4_999)) && dialogue.is_silent(Millis(5_000)));
    // Noise does not count as a board.
    dialogue.bytes(Millis(4_000), 0.0, b"login: \xff\r\n", |_| {});
    assert!(!dialogue.has_received() && dialogue.is_silent(Millis(5_000)));
    dialogue.bytes(Millis(6_000), 0.0, report(0).as_bytes(), |_| {});
    assert!(dialogue.has_received() && !dialogue.is_silent(Millis(10_999)));
}

proptest! {
    #[test]
    fn a_line_cut_out_anywhere_is_noticed_and_what_follows_is_read(
        from in 0_usize..2_000, length in 0_usize..400, noise: Vec<u8>,
    ) {
        let lines: Vec<String> = (0..50).map(|pair| emg(2 * pair)).collect();
        let mut bytes = lines.concat().into_bytes();
        let to = bytes.len().min(from + length);
        let from = from.min(to);
        // A line end ends whatever the noise began.
        let noise: Vec<u8> = noise.into_iter().chain(*b"\r\n").collect();
        bytes.splice(from..to, noise);
        bytes.extend(emg(100).bytes());
        let mut dialogue = dialogue();
        let (mut received, mut last) = (0, None);
        for event in events(&mut dialogue, &bytes) {
            if let BoardEvent::Samples(report, _) = event {
                prop_assert_eq!(report.samples[0], [report.first.0 as i8; 8]);
                received += 2;
                last = Some(report.first.0);
            }
        }
        prop_assert_eq!(last, Some(100));
        // Losses before the first heard line are unknown.
        let Losses { samples, .. } = dialogue.state.losses;
        prop_assert!(received + samples <= 102 && received >= 60, "{received} {samples}");
        if from > 60 {
            prop_assert_eq!(received + samples, 102);
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes: Vec<u8>) {
        events(&mut dialogue(), &bytes);
    }
}

#[test]
fn movement_is_asked_for_where_it_is_wanted_and_again_with_the_samples() {
    let mut dialogue = Dialogue::new(Millis(0), Losses::default(), true);
    let mut asked = Vec::new();
    for now in 0..3_000 {
        while let Some(command) = dialogue.command(Millis(now)) {
            if matches!(command, Command::Raw(_) | Command::Imu(_)) {
                asked.push((now, command));
            }
        }
        // Samples come after the second time.
        if now > 1_000 && now % 10 == 0 {
            dialogue.bytes(Millis(now), 0.0, emg(now / 5).as_bytes(), |_| {});
        }
    }
    let expected = [0, 1_000].map(|now| [(now, Command::Raw(true)), (now, Command::Imu(true))]);
    assert_eq!(asked, expected.as_flattened());
    let imu = Imu([1; 10]);
    let sample = SampleIndex(7);
    let events = events(
        &mut dialogue,
        ImuReport { sample, imu }.to_string().as_bytes(),
    );
    let (at, sample) = (0.0, 7);
    assert_eq!(
        events[0],
        BoardEvent::Publish(Event::Imu { at, sample, imu })
    );
}
