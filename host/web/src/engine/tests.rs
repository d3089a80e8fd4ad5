use recordings::synthetic::{self, SynthOptions};
use recordings::{LoadOptions, load_bytes};
use shared::installation::InstallationProgress;
use shared::model::file::Model;
use shared::myo::{Address, Characteristic};
use shared::stream::alignment::Alignment;
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::{AlignCommand, Command, CommandReader};
use shared::units::{Sample, SampleIndex};

use super::*;
use crate::SHIPPED;
use crate::installer::tests::identity;
use crate::outcome::InstallationState;
use crate::record::journal::FULL;
use crate::simulated_armband::SimulatedArmband;

const SETTINGS: Settings<'static> = Settings {
    now: 0.0,
    model: None,
    imu: false,
    speed: 1,
};
const ADDRESS: &str = "FA:12:34:56:78:9A";

/// Request for a task, and the notification with which an armband's wearer makes it: labels are valid.
const PLAY: &[u8] = br#"{"do":"blocks","begin":true}"#;
const PLAYED_AFTER: usize = 350;

/// States of a task, one after another, and the number of its blocks.
fn played<'e>(events: impl IntoIterator<Item = &'e Event>) -> (Vec<&'static str>, u32) {
    let played = events.into_iter().filter_map(|event| match event {
        Event::Blocks { state, moved, .. } => Some((*state, *moved)),
        _ => None,
    });
    let (mut states, moved): (Vec<_>, Vec<_>) = played.unzip();
    states.dedup();
    (states, moved.last().copied().unwrap_or_default())
}

/// Follows the armband of an address until it has sent all of its samples. The link is lost once after so many notifications, if it
/// is to be. Returns the events, and the radio's actions.
fn followed(imu: bool, samples: &[Sample], lost_after: Option<usize>) -> (Vec<Event>, Vec<Action>) {
    let mut armband = SimulatedArmband::default();
    let mut pairs = samples.as_chunks().0.iter().zip(1..);
    let mut engine = Engine::default();
    let settings = Settings { imu, ..SETTINGS };
    let address = Address::parse(ADDRESS).ok();
    engine.armband(&settings, address).unwrap();
    let (mut events, mut taken) = (Vec::new(), Vec::new());
    for now in (0..).map(|tick| f64::from(tick) * 10.0) {
        engine.tick(now);
        if armband.streams() {
            let Some((pair, sent)) = pairs.next() else {
                break;
            };
            armband.notify(*pair);
            if sent == PLAYED_AFTER {
                engine.request(now, PLAY, &[]);
            }
            if lost_after == Some(sent) {
                armband.lose();
            }
        }
        loop {
            for output in engine.take() {
                match output {
                    Output::Event(event) => events.push(event),
                    Output::Radio(action) => {
                        taken.push(action);
                        armband.act(action);
                    }
                    other => panic!("{other:?}"),
                }
            }
            let heard = armband.events();
            if heard.is_empty() {
                break;
            }
            for event in &heard {
                engine.radio(now, event);
            }
        }
    }
    (events, taken)
}

/// Whether an action turns EMG on, and movement if wanted.
fn sets_mode(action: &Action, imu: bool) -> bool {
    matches!(action, Action::Write(_, payload) if payload.as_slice() == [1, 3, 2, u8::from(imu), 0])
}

fn recording() -> Vec<Sample> {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 12,
        ..SynthOptions::default()
    };
    synthetic::generate(&options).remove(0).samples
}

#[test]
fn an_armband_is_followed_and_labelled_as_on_a_board_and_found_again_when_it_is_lost() {
    let samples = recording();
    let half = samples.len() / 4;
    let (events, taken) = followed(false, &samples, Some(half));
    assert_eq!(played(&events).0, ["running", "interrupted"]);
    let (mut emg, mut shown, mut connected) = (Vec::new(), Vec::new(), Vec::new());
    for event in events {
        match event {
            Event::Samples {
                first, emg: pair, ..
            } => {
                assert_eq!(first as usize, emg.len());
                emg.extend(pair);
            }
            Event::Report {
                instant,
                label,
                valid,
                ..
            } => shown.push((instant, label, valid)),
            Event::Source { connected: is, .. } => connected.push(is),
            Event::Board {
                armband, battery, ..
            } if battery.is_some() => {
                assert_eq!(battery, Some(80));
                assert!(armband.is_none_or(|armband| armband == ADDRESS));
            }
            _ => {}
        }
    }
    assert_eq!(emg, samples);
    // Labels of the first connection; the first report is of the state before it.
    let mut scored = ScoredPipeline::open(SHIPPED).unwrap();
    let first = samples[..2 * half].iter().zip(0..);
    let reports = first.flat_map(|(&sample, index)| {
        scored
            .sample(Millis(0), 0.0, SampleIndex(index), sample)
            .reports
    });
    let label = |report: shared::uart_line::Report| {
        (
            report.instant.0,
            report.status.label().name(),
            report.status.valid(),
        )
    };
    let expected: Vec<_> = reports.map(label).collect();
    assert!(expected.len() > 10, "{expected:?}");
    let begun = shown
        .iter()
        .position(|report| *report == expected[0])
        .unwrap();
    assert_eq!(shown[begun..][..expected.len()], expected);
    connected.dedup();
    assert_eq!(connected, [false, true, false, true]);
    let connects = |action: &&Action| matches!(action, Action::Connect(_));
    assert_eq!(taken.iter().filter(connects).count(), 2);
    // At its first advertisement.
    assert_eq!(taken[..2], [Action::Scan, Action::StopScan]);
}

#[test]
fn whoever_was_recorded_has_a_score() {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 60,
        ..SynthOptions::default()
    };
    let mut engine = Engine::default();
    let own = synthetic::generate(&options).remove(0);
    engine.replay(&SETTINGS, own).unwrap();
    run(&mut engine, 0, 4000);
    engine.request(4000.0, PLAY, &[]);
    let outputs = run(&mut engine, 4000, 80_000);
    let events = outputs.iter().filter_map(|output| match output {
        Output::Event(event) => Some(event),
        _ => None,
    });
    let (states, moved) = played(events);
    assert_eq!(
        (states, moved > 1),
        (vec!["running", "done"], true),
        "{moved}"
    );
}

#[test]
fn movement_comes_where_it_is_wanted_numbered_by_the_sample_that_is_due() {
    for imu in [false, true] {
        let (events, taken) = followed(imu, &recording()[..400], None);
        let moved = events.iter().filter_map(|event| match event {
            Event::Imu { sample, imu, .. } => Some((*sample, *imu)),
            _ => None,
        });
        let moved: Vec<_> = moved.collect();
        let subscribes = taken.contains(&Action::Subscribe(Characteristic::Imu));
        let asked = [subscribes, taken.iter().any(|own| sets_mode(own, true))];
        assert_eq!((asked, moved.len() > 50), ([imu; 2], imu), "{taken:?}");
        for ((due, movement), (next, _)) in moved.iter().zip(moved.iter().skip(1)) {
            assert_eq!(movement.quaternion(), [1.0, 0.0, 0.0, 0.0]);
            assert_eq!(movement.acceleration(), [0.0, 0.0, -1.0]);
            assert_eq!(movement.turn_rate(), [0.0; 3]);
            assert_eq!((due % 4, *next), (0, due + 4));
        }
    }
}

/// Program's engine with a session of the demo, after a second.
fn recording_engine() -> Engine {
    let mut engine = Engine::default();
    engine.demo(&SETTINGS, Some(0)).unwrap();
    let protocol = Protocol::find("quick").unwrap();
    engine.record(0.0, "anna".to_owned(), protocol, 1.75e12, false);
    run(&mut engine, 0, 1000);
    engine
}

/// Lets time pass between two times in ms, and returns the outputs.
fn run(engine: &mut Engine, from: u32, to: u32) -> Vec<Output> {
    let times = (from..to).step_by(10);
    let outputs = times.flat_map(|now| {
        engine.tick(f64::from(now));
        engine.take()
    });
    outputs.collect()
}

/// Phase, reason and trouble of the newest view.
fn view(outputs: &[Output]) -> (&'static str, Option<HoldReason>, &str) {
    let view = outputs.iter().rev().find_map(|output| match output {
        Output::Event(Event::Session { view, trouble }) => Some((
            view.phase,
            view.why,
            trouble.as_ref().map_or("", |trouble| &trouble.text),
        )),
        _ => None,
    });
    view.unwrap()
}

fn wish(engine: &mut Engine, now: f64, viewer: ViewerId, wish: &str) -> Vec<Output> {
    let text = format!(r#"{{"do":"session","wish":"{wish}"}}"#);
    engine.request_of(now, viewer, &serde_json::from_str(&text).unwrap());
    engine.take()
}

fn lines(outputs: &[Output]) -> impl Iterator<Item = &Lines> {
    outputs.iter().filter_map(|output| match output {
        Output::Journal(lines) => Some(lines),
        _ => None,
    })
}

#[test]
fn what_becomes_of_the_journal_holds_the_session_and_is_told() {
    let mut engine = recording_engine();
    let begun = wish(&mut engine, 1000.0, 1, "begin");
    let [first] = lines(&begun).collect::<Vec<_>>()[..] else {
        panic!("{begun:?}");
    };
    assert!(first.begins && !first.is_over && first.journal.contains("anna"));
    assert_eq!(first.name, "anna_20250615T150641Z_quick");
    // It cannot be begun: the session waits as before.
    engine.stored(1000.0, Stored::Refused(Said::plain("no folder")));
    assert_eq!(view(&engine.take()), ("waiting", None, "no folder"));
    run(&mut engine, 1010, 1100);
    wish(&mut engine, 1100.0, 1, "begin");
    let written = run(&mut engine, 1110, 2000);
    assert!(lines(&written).count() > 5 && lines(&written).all(|lines| !lines.begins));
    // The disk is full, and has room again.
    for why in ["full", "still full"] {
        engine.stored(2000.0, Stored::Failed(HoldReason::Disk, Said::plain(why)));
    }
    let held = ("held", Some(HoldReason::Disk), "full");
    assert_eq!(view(&engine.take()), held);
    engine.stored(2000.0, Stored::Written);
    assert_eq!(view(&engine.take()), ("held", Some(HoldReason::Disk), ""));
    wish(&mut engine, 2010.0, 1, "begin");
    // It was moved, which is told until the person goes on.
    engine.stored(2020.0, Stored::Anew(Said::plain("moved")));
    let held = ("held", Some(HoldReason::Gone), "moved");
    assert_eq!(view(&engine.take()), held);
    let gone_on = wish(&mut engine, 2030.0, 1, "begin");
    assert_eq!(view(&gone_on), ("ready", None, ""));
    let over = wish(&mut engine, 2040.0, 1, "finish");
    assert!(lines(&over).last().unwrap().is_over);
    // While it was written there was nothing to tune on.
    assert!(wish(&mut engine, 2050.0, 1, "tune").contains(&Output::Tune));
}

#[test]
fn a_session_ends_before_its_journal_is_too_long_to_be_read() {
    let mut engine = recording_engine();
    wish(&mut engine, 1000.0, 1, "begin");
    engine.outputs.recording.as_mut().unwrap().given = FULL;
    let outputs = run(&mut engine, 1010, 1300);
    let (phase, _, trouble) = view(&outputs);
    assert_eq!(phase, "over");
    assert!(
        trouble.starts_with("a session cannot last longer"),
        "{trouble}"
    );
}

#[test]
fn the_first_viewer_who_asks_leads_until_it_leaves_and_the_session_waits() {
    let mut engine = recording_engine();
    let refused = |outputs: &[Output]| {
        outputs.iter().find_map(|output| match output {
            Output::Answer(viewer, refused) => Some((*viewer, refused.clone())),
            _ => None,
        })
    };
    wish(&mut engine, 1000.0, 1, "begin");
    let watched = wish(&mut engine, 1000.0, 2, "finish");
    assert_eq!(
        refused(&watched),
        Some((2, Event::refused(NotDone::Watches)))
    );
    engine.left(1010.0, 2);
    assert_eq!(engine.take(), []);
    engine.left(1010.0, 1);
    let left = engine.take();
    assert!(left.contains(&Output::Event(Event::Lead { viewer: None })));
    assert_eq!(view(&left), ("held", Some(HoldReason::LeaderLeft), ""));
    let gone_on = wish(&mut engine, 1020.0, 2, "begin");
    assert_eq!(view(&gone_on).0, "ready");
    assert_eq!(refused(&gone_on), None);
}

#[test]
fn an_unattended_session_begins_goes_on_and_ends_with_its_trouble() {
    let mut engine = Engine::default();
    engine.demo(&SETTINGS, Some(0)).unwrap();
    let protocol = Protocol::find("quick").unwrap();
    engine.record(0.0, "anna".to_owned(), protocol, 0.0, false);
    assert_eq!(engine.lead_unattended(0.0), Ok(false));
    run(&mut engine, 0, 100);
    assert_eq!(engine.lead_unattended(100.0), Ok(false));
    assert_eq!(view(&engine.take()).0, "ready");
    engine.stored(100.0, Stored::Failed(HoldReason::Disk, Said::plain("full")));
    assert_eq!(engine.lead_unattended(100.0), Err(Said::plain("full")));
    engine.stored(100.0, Stored::Written);
    engine.finish(100.0);
    engine.take();
    assert_eq!(engine.lead_unattended(100.0), Ok(true));
}

#[test]
fn a_board_is_told_a_placement_once_its_port_is_open() {
    let mut engine = Engine::default();
    engine.board(&SETTINGS, "x".to_owned(), true).unwrap();
    let place = |engine: &mut Engine, turn: u8| {
        let text = format!(r#"{{"do":"place","turn":{turn},"mirrored":true}}"#);
        engine.request_of(0.0, 1, &serde_json::from_str(&text).unwrap());
        engine.take()
    };
    let lead = place(&mut engine, 2);
    assert_eq!(lead, [Output::Event(Event::Lead { viewer: Some(1) })]);
    engine.port(0.0, Ok(()));
    engine.take();
    let set = AlignCommand::Set(Alignment::new(2, true));
    let line = Command::Align(set).to_string();
    assert_eq!(place(&mut engine, 2), [Output::Line { line }]);
    // There are eight places, and no session.
    let refused = |outputs: &[Output], why| *outputs == [Output::Answer(1, Event::refused(why))];
    assert!(refused(&place(&mut engine, 8), NotDone::Unknown));
    assert!(refused(
        &wish(&mut engine, 0.0, 1, "begin"),
        NotDone::NoSession
    ));
    engine.request(0.0, br#"{"do":"turn"}"#, &[]);
    assert!(refused(&engine.take(), NotDone::NoTurn));
}

/// Answers the commands of the outputs as a board with the shipped model does. Returns the states of the installation, and the
/// commands that it takes.
fn answer(
    engine: &mut Engine,
    now: f64,
    taken: Result<InstallationProgress, Refusal>,
) -> (Vec<InstallationState>, usize) {
    let (mut states, mut begins) = (Vec::new(), 0);
    loop {
        engine.tick(now);
        let mut heard = String::new();
        for output in engine.take() {
            match output {
                Output::Event(Event::Installing(state)) => states.push(state),
                Output::Line { line } => {
                    let mut reader = CommandReader::default();
                    let command = line.bytes().find_map(|byte| reader.push(byte));
                    let checksum = Model::parse(SHIPPED).unwrap().checksum;
                    heard += &match command.unwrap().unwrap() {
                        Command::Identify => identity(Some(checksum)),
                        Command::Install(_) => {
                            begins += 1;
                            taken.map_or_else(Answer::Refused, Answer::Install)
                        }
                        _ => continue,
                    }
                    .to_string();
                }
                _ => {}
            }
        }
        if heard.is_empty() {
            return (states, begins);
        }
        engine.heard(now, heard.as_bytes());
    }
}

#[test]
fn an_installation_waits_for_the_board_goes_on_after_a_loss_and_says_how_it_ends() {
    let mut engine = Engine::default();
    engine.board(&SETTINGS, "x".to_owned(), true).unwrap();
    let refused = engine.install(0.0, &SHIPPED[..999]);
    assert_eq!(refused, Ok(()));
    let state = |outputs: &[Output]| match outputs {
        [Output::Event(Event::Installing(state))] => (
            state.state,
            state
                .why
                .as_ref()
                .map_or(String::new(), ToString::to_string),
        ),
        outputs => panic!("{outputs:?}"),
    };
    let (failed, why) = state(&engine.take());
    assert!(
        failed == "failed" && why.starts_with("no board can run this file"),
        "{why}"
    );
    // Nothing is sent before the port is open, or while it is lost.
    engine.install(0.0, SHIPPED).unwrap();
    assert_eq!(state(&engine.take()).0, "running");
    engine.tick(40_000.0);
    assert_eq!(engine.take(), []);
    for begun in [40_000.0, 60_000.0] {
        engine.port(begun, Ok(()));
        let (states, begins) = answer(&mut engine, begun, Ok(InstallationProgress::Next(0)));
        assert_eq!(begins, 1);
        assert!(states.iter().all(|state| state.state == "running"));
        engine.port(begun, Err((Said::plain("pulled"), Vec::new())));
        engine.take();
    }
    engine.port(61_000.0, Ok(()));
    let (states, _) = answer(&mut engine, 61_000.0, Ok(InstallationProgress::Installed));
    let last = states.last().unwrap();
    assert_eq!((last.state, last.blocks, last.of), ("done", 100, 100));
    // A board that is lost for good is given up, and one that refuses has its words.
    engine.install(62_000.0, SHIPPED).unwrap();
    answer(&mut engine, 62_000.0, Ok(InstallationProgress::Next(0)));
    engine.port(62_000.0, Err((Said::plain("pulled"), Vec::new())));
    engine.take();
    engine.tick(93_000.0);
    assert_eq!(state(&engine.take()).0, "failed");
    engine.port(94_000.0, Ok(()));
    engine.install(94_000.0, SHIPPED).unwrap();
    let (states, _) = answer(&mut engine, 94_000.0, Err(Refusal::Length));
    let last = states.last().unwrap();
    let why = last.why.as_ref().unwrap();
    assert!(why.text.starts_with("the board refuses: "), "{why}");
    assert_eq!(why.name, "board.refused");
}

#[test]
fn without_a_board_a_model_runs_here_and_one_that_is_refused_does_not() {
    let mut engine = Engine::default();
    engine.demo(&SETTINGS, None).unwrap();
    let run = |engine: &mut Engine, from: u32| {
        (from..from + 5000)
            .step_by(10)
            .for_each(|now| engine.tick(f64::from(now)));
        engine.take()
    };
    run(&mut engine, 0);
    engine.install(5000.0, models::SHIPPED[1].1).unwrap();
    let outputs = engine.take();
    let runs = |output: &Output| matches!(output, Output::Event(Event::Model { classes, .. }) if classes.len() == 5);
    let is_done = |output: &Output| matches!(output, Output::Event(Event::Installing(state)) if state.state == "done");
    assert!(runs(&outputs[0]) && is_done(&outputs[2]), "{outputs:?}");
    // Samples go on, and an alignment stays.
    let place = br#"{"do":"place","turn":3,"mirrored":false}"#;
    engine.request(5000.0, place, &[]);
    let is_placed = |output: &Output| matches!(output, Output::Event(Event::Alignment { .. }));
    assert!(engine.take().iter().any(is_placed));
    engine.install(5000.0, models::SHIPPED[1].1).unwrap();
    let outputs = run(&mut engine, 5000);
    assert!(!outputs.iter().any(is_placed));
    let goes_on = |output: &Output| matches!(output, Output::Event(Event::Report { is_label: true, emitted, .. }) if *emitted > 1000);
    assert!(outputs.iter().any(goes_on), "{outputs:?}");
    engine.install(10_000.0, b"no model").unwrap();
    let outputs = engine.take();
    let [Output::Event(Event::Installing(state))] = &outputs[..] else {
        panic!("{outputs:?}");
    };
    assert_eq!(state.state, "failed");
}

#[test]
fn a_session_that_a_page_keeps_takes_no_work_of_a_program() {
    let mut engine = Engine::open(0.0, &Wanted::Demo, &[], None);
    engine.take();
    let mut said = |text: &str| {
        engine.request(0.0, text.as_bytes(), &[]);
        engine.take()
    };
    let begun = said(r#"{"do":"record","person":"anna","protocol":"quick","time":0}"#);
    // As a program does to a new viewer, it says what is known.
    let is_hello =
        |output: &Output| matches!(output, Output::Event(Event::Hello { record, .. }) if *record);
    let is_source = |output: &Output| matches!(output, Output::Event(Event::Source { .. }));
    assert!(
        is_hello(&begun[0]) && begun.iter().any(is_source),
        "{begun:?}"
    );
    for wish in ["tune", "install"] {
        let outputs = said(&format!(r#"{{"do":"session","wish":"{wish}"}}"#));
        assert_eq!(
            outputs,
            [Output::Answer(1, Event::refused(NotDone::Unknown))]
        );
    }
    let refused = said(r#"{"do":"bind"}"#);
    assert_eq!(
        refused,
        [Output::Answer(1, Event::refused(NotDone::NoBoard))]
    );
}

/// Lets a simulated board run, and returns the events of so many seconds.
fn seconds(engine: &mut Engine, now: &mut u32, seconds: u32) -> Vec<Event> {
    let from = *now;
    *now += seconds * 1000;
    let outputs = run(engine, from, *now).into_iter();
    let events = outputs.map(|output| match output {
        Output::Event(event) => event,
        // The line leads to the simulated board.
        other => panic!("{other:?}"),
    });
    events.collect()
}

/// State of the newest calibration, and whether one is in use.
fn calibrated(events: &[Event]) -> (Vec<&'static str>, bool) {
    let told = events.iter().filter_map(|event| match event {
        Event::Calibration { state, in_use, .. } => Some((*state, *in_use)),
        _ => None,
    });
    let (mut states, in_use): (Vec<_>, Vec<_>) = told.unzip();
    states.dedup();
    (states, in_use.last() == Some(&true))
}

/// Label, validity and instant of the reports.
fn reported(events: &[Event]) -> Vec<(u32, &'static str, bool)> {
    let reports = events.iter().filter_map(|event| match event {
        Event::Report {
            instant,
            label,
            valid,
            ..
        } => Some((*instant, *label, *valid)),
        _ => None,
    });
    reports.collect()
}

#[test]
fn a_simulated_board_takes_every_step_of_a_board_over_its_line() {
    let mut engine = Engine::open(0.0, &Wanted::SimulatedBoard, &[], None);
    engine.take();
    let mut now = 0;
    let say = |engine: &mut Engine, now: u32, text: &str| {
        engine.request(f64::from(now), text.as_bytes(), &[]);
    };
    // It says what it is, and its labels are those of the same pipeline.
    let events = seconds(&mut engine, &mut now, 15);
    let checksum = format!("{:08x}", Model::parse(SHIPPED).unwrap().checksum);
    let identity = events.iter().rev().find_map(|event| match event {
        Event::Board {
            image,
            model,
            armband,
            battery,
            ..
        } => Some((&**image, model.clone(), armband.as_deref(), *battery)),
        _ => None,
    });
    let expected = ("simulated", Some(checksum), Some(ADDRESS), Some(80));
    assert_eq!(identity, Some(expected));
    assert!(
        events
            .iter()
            .any(|event| matches!(event, Event::Imu { .. }))
    );
    assert!(
        events
            .iter()
            .any(|event| matches!(event, Event::Scores { .. }))
    );
    let mut scored = ScoredPipeline::open(SHIPPED).unwrap();
    let mut expected = Vec::new();
    for event in &events {
        if let Event::Samples { first, emg, .. } = event {
            for (&sample, index) in emg.iter().zip(*first..) {
                let found = scored.sample(Millis(0), 0.0, SampleIndex(index), sample);
                found.events(0.0, &mut |event| expected.push(event));
            }
        }
    }
    let labels = reported(&events);
    assert!(labels.len() > 100, "{labels:?}");
    // The first report is of its start.
    assert_eq!(labels[1..], reported(&expected));

    // The armband is turned, which an alignment finds, and turned back.
    let placed = |events: &[Event]| {
        events.iter().rev().find_map(|event| match event {
            Event::Alignment { state, turn, .. } => Some((*state, *turn)),
            _ => None,
        })
    };
    say(&mut engine, now, r#"{"do":"turn"}"#);
    say(&mut engine, now, r#"{"do":"align"}"#);
    let events = seconds(&mut engine, &mut now, 15);
    assert_eq!(placed(&events), Some(("aligned", 3)));
    say(&mut engine, now, r#"{"do":"turn"}"#);
    say(
        &mut engine,
        now,
        r#"{"do":"place","turn":0,"mirrored":false}"#,
    );
    assert_eq!(placed(&seconds(&mut engine, &mut now, 1)), Some(("set", 0)));

    // A calibration is kept while no label is valid, and taken back.
    say(&mut engine, now, r#"{"do":"calibrate","wish":"begin"}"#);
    let events = seconds(&mut engine, &mut now, 40);
    let states = ["teaching", "judging", "done"];
    assert_eq!(calibrated(&events), (states.to_vec(), true));
    let causes = |events: &[Event], wanted| {
        let is = |event: &Event| matches!(event, Event::Report { cause: Some(cause), .. } if *cause == wanted);
        events.iter().any(is)
    };
    assert!(causes(&events, "installation"));
    assert!(reported(&events).last().unwrap().2, "valid again");
    say(&mut engine, now, r#"{"do":"calibrate","wish":"forget"}"#);
    let events = seconds(&mut engine, &mut now, 2);
    assert_eq!(calibrated(&events), (vec!["keeping", "idle"], false));

    // Its wearer plays.
    engine.request(f64::from(now), PLAY, &[]);
    let (states, moved) = played(&seconds(&mut engine, &mut now, 75));
    assert_eq!(
        (states, moved > 5),
        (vec!["running", "done"], true),
        "{moved}"
    );

    // A pairing takes 30 s, in which nothing streams.
    say(&mut engine, now, r#"{"do":"bind"}"#);
    let events = seconds(&mut engine, &mut now, 40);
    let bound = events.iter().filter_map(|event| match event {
        Event::Binding { state, kept, .. } => Some((*state, *kept)),
        _ => None,
    });
    let mut bound: Vec<_> = bound.collect();
    bound.dedup();
    assert_eq!(bound, [("pairing", true), ("bound", true)]);
    assert!(causes(&events, "disconnected"));
    assert!(reported(&events).last().unwrap().2, "valid again");

    // Another model is installed over the line, block by block.
    engine
        .install(f64::from(now), models::SHIPPED[1].1)
        .unwrap();
    let events = seconds(&mut engine, &mut now, 20);
    let states: Vec<_> = events
        .iter()
        .filter_map(|event| match event {
            Event::Installing(state) => Some((state.state, state.blocks)),
            _ => None,
        })
        .collect();
    let (end, of) = *states.last().unwrap();
    assert_eq!((end, states.len() > 90), ("done", of > 90), "{states:?}");
    assert!(causes(&events, "installation"));
    let classes = events.iter().rev().find_map(|event| match event {
        Event::Model { classes, .. } => Some(classes.len()),
        _ => None,
    });
    assert_eq!(classes, Some(5));
    assert!(reported(&events).last().unwrap().2, "valid again");
    // Its recordings are those of no person.
    assert_eq!(engine.source, ("simulated USB".to_owned(), true));
}

/// Names and contents of the files that a page is given.
fn files(outputs: &[Output]) -> Vec<(&str, &str)> {
    let files = outputs.iter().filter_map(|output| match output {
        Output::Event(Event::File { name, content }) => Some((&**name, &**content)),
        _ => None,
    });
    files.collect()
}

#[test]
fn what_a_killed_tab_had_written_becomes_the_recordings_and_notes_of_its_session() {
    let keep = br#"{"do":"keep"}"#;
    let mut tab = Engine::open(0.0, &Wanted::Demo, &[], None);
    run(&mut tab, 0, 1000);
    let record = br#"{"do":"record","person":"anna","protocol":"quick","time":1.75e12}"#;
    tab.request(1000.0, record, &[]);
    run(&mut tab, 1000, 2000);
    tab.request(2000.0, br#"{"do":"session","wish":"begin"}"#, &[]);
    tab.request(2000.0, br#"{"do":"note","text":"a loose band"}"#, &[]);
    let outputs = run(&mut tab, 2000, 62_000);
    let lines = outputs.iter().filter_map(|output| match output {
        Output::Journal(lines) | Output::Remark(lines) => Some(&*lines.journal),
        _ => None,
    });
    let written: String = lines.collect();
    tab.request(62_000.0, br#"{"do":"session","wish":"finish"}"#, &[]);
    tab.take();
    tab.request(62_000.0, keep, &[]);
    let over = tab.take();
    let [notes, (name, csv)] = files(&over)[..] else {
        panic!("{over:?}");
    };
    assert_eq!(notes.0, "anna_20250615T150641Z_quick.notes");
    assert!(notes.1.contains("a loose band"));
    assert_eq!(name, "anna_20250615T150641Z_quick_1.csv");
    let samples = |csv: &str| {
        let library = load_bytes("a.csv".as_ref(), csv.as_bytes(), &LoadOptions::default());
        library.unwrap().recordings.remove(0).samples
    };
    let whole = samples(csv);
    assert!(whole.len() > 59 * 200, "{}", whole.len());

    // Another tab has the journal without its end, which was not written yet.
    let mut later = Engine::open(0.0, &Wanted::Demo, &[], None);
    let mut recovered = |kept: &str| {
        let recover = br#"{"do":"recover","name":"anna_20250615T150641Z_quick"}"#;
        later.request(1.0, recover, kept.as_bytes());
        later.request(1.0, keep, &[]);
        later.take()
    };
    let refused = recovered("no journal");
    assert!(
        refused
            .iter()
            .any(|output| matches!(output, Output::Answer(1, Event::Refused { .. })))
    );
    let found = recovered(&written[..written.len() - 7]);
    let found = files(&found);
    assert_eq!((found.len(), found[0]), (2, notes));
    let read = samples(found[1].1);
    assert!(read.len() > whole.len() - 60, "{}", read.len());
    assert_eq!(read, whole[..read.len()]);
    // A session that never began has its notes alone.
    assert_eq!(files(&recovered(notes.1)), [notes]);
}

#[test]
fn two_sessions_of_the_demo_are_not_of_equal_samples() {
    let [one, other] = [0, 1].map(|earlier| {
        let mut engine = Engine::default();
        engine.demo(&SETTINGS, Some(earlier)).unwrap();
        let outputs = run(&mut engine, 0, 10_000);
        let samples = outputs.into_iter().filter_map(|output| match output {
            Output::Event(Event::Samples { emg, .. }) => Some(emg),
            _ => None,
        });
        samples.flatten().collect::<Vec<Sample>>()
    });
    let equal = one.iter().zip(&other).filter(|(one, other)| one == other);
    // Rest has few values: some samples are equal by chance.
    assert!(20 * equal.count() < one.len());
}
