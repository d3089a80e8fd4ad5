use std::collections::VecDeque;

use recordings::synthetic::{self, SynthOptions};
use shared::installation::InstallationProgress;
use shared::model::file::Model;
use shared::myo::{Address, Characteristic};
use shared::stream::alignment::Alignment;
use shared::uart_line::answer::{Answer, Identity, Refusal};
use shared::uart_line::command::{AlignCommand, Command, CommandReader};
use shared::units::{Sample, SampleIndex};

use super::*;
use crate::SHIPPED;
use crate::outcome::InstallationState;
use crate::record::journal::FULL;

const SETTINGS: Settings<'static> = Settings {
    now: 0.0,
    model: None,
    imu: false,
    speed: 1,
};
const ADDRESS: &str = "FA:12:34:56:78:9A";
/// Firmware version 1.5.1970, hardware revision 2.
const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];

/// Armband and Bluetooth stack, simulated.
#[derive(Default)]
struct Peripheral {
    samples: Vec<Sample>,
    /// Number of notifications after which the link is lost, once.
    lost_after: Option<usize>,
    /// Notifications of the recording sent so far, over all connections.
    sent: usize,
    lane: usize,
    streams: bool,
    /// Whether its IMU is subscribed to, and on in its mode.
    imu: (bool, bool),
    /// Names of the actions, and events that the engine has not heard yet.
    taken: Vec<&'static str>,
    events: VecDeque<RadioEvent>,
}

impl Peripheral {
    fn act(&mut self, action: Action) {
        let (name, event) = match action {
            Action::Scan => (
                "scan",
                RadioEvent::Advertisement {
                    address: Address::parse(ADDRESS).unwrap(),
                    rssi: -50,
                    data: advertising_data([Uuid::CONTROL.to_le_bytes()]),
                },
            ),
            Action::StopScan => return self.taken.push("stop"),
            Action::Connect(_) => ("connect", RadioEvent::Connected),
            Action::Discover => {
                let found = Characteristic::ALL.into_iter().collect();
                ("discover", RadioEvent::Discovered { found })
            }
            Action::Read(Characteristic::FirmwareVersion) => {
                let bytes = FIRMWARE.to_vec();
                ("firmware", RadioEvent::Read { bytes })
            }
            Action::Read(_) => ("battery", RadioEvent::Read { bytes: vec![80] }),
            Action::Subscribe(Characteristic::Imu) => {
                self.imu.0 = true;
                ("subscribe to the IMU", RadioEvent::Done)
            }
            Action::Subscribe(_) => ("subscribe", RadioEvent::Done),
            Action::Write(_, payload) => match payload.as_slice() {
                [1, 3, 2, imu, 0] => {
                    (self.streams, self.imu.1) = (true, *imu == 1);
                    (if self.imu.1 { "imu" } else { "stream" }, RadioEvent::Done)
                }
                _ => ("write", RadioEvent::Done),
            },
            other => panic!("{other:?} is for the pipeline"),
        };
        self.taken.push(name);
        self.events.push_back(event);
    }

    /// Sends the next samples of the recording, on the four characteristics in turn, and behind every second notification what
    /// the IMU says: its turn is the number of the notification.
    fn notify(&mut self) {
        let pair: [Sample; 2] = self.samples[2 * self.sent..][..2].try_into().unwrap();
        self.events.push_back(RadioEvent::Notification {
            characteristic: Characteristic::ALL[2 + self.lane],
            bytes: pair
                .as_flattened()
                .iter()
                .map(|&value| value.cast_unsigned())
                .collect(),
        });
        self.lane = (self.lane + 1) % 4;
        self.sent += 1;
        if self.imu == (true, true) && self.sent.is_multiple_of(2) {
            let imu = [16_384, 0, 0, 0, 0, 0, -2048, self.sent as i16, 0, 0].map(i16::to_le_bytes);
            self.events.push_back(RadioEvent::Notification {
                characteristic: Characteristic::Imu,
                bytes: imu.as_flattened().to_vec(),
            });
        }
        if self
            .lost_after
            .take_if(|after| *after == self.sent)
            .is_some()
        {
            self.events.push_back(RadioEvent::Disconnected);
            (self.lane, self.streams, self.imu) = (0, false, (false, false));
        }
    }
}

/// Follows an armband until it has sent all of its samples. Returns the events, and the names of the radio's actions.
fn followed(
    pinned: Option<Address>,
    imu: bool,
    samples: &[Sample],
    lost_after: Option<usize>,
) -> (Vec<Event>, Vec<&'static str>) {
    let mut peripheral = Peripheral {
        samples: samples.to_vec(),
        lost_after,
        ..Peripheral::default()
    };
    let mut engine = Engine::default();
    let settings = Settings { imu, ..SETTINGS };
    engine.armband(&settings, pinned).unwrap();
    let mut events = Vec::new();
    for now in (0..).map(|tick| f64::from(tick) * 10.0) {
        engine.tick(now);
        if peripheral.streams {
            peripheral.notify();
        }
        loop {
            for output in engine.take() {
                match output {
                    Output::Event(event) => events.push(event),
                    Output::Radio(action) => peripheral.act(action),
                    other => panic!("{other:?}"),
                }
            }
            match peripheral.events.pop_front() {
                Some(event) => engine.radio(now, &event),
                None => break,
            }
        }
        if 2 * peripheral.sent == peripheral.samples.len() {
            break;
        }
    }
    (events, peripheral.taken)
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
    let (events, taken) = followed(None, false, &samples, Some(half));
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
    assert_eq!(taken.iter().filter(|name| **name == "connect").count(), 2);
}

#[test]
fn an_armband_of_an_address_is_connected_to_at_its_first_advertisement() {
    let address = Address::parse(ADDRESS).unwrap();
    let (_, taken) = followed(Some(address), false, &recording()[..400], None);
    assert_eq!(taken[..2], ["scan", "stop"]);
    assert!(taken.contains(&"stream"), "{taken:?}");
}

#[test]
fn movement_comes_where_it_is_wanted_numbered_by_the_sample_that_is_due() {
    for imu in [false, true] {
        let (events, taken) = followed(None, imu, &recording()[..400], None);
        let moved = events.iter().filter_map(|event| match event {
            Event::Imu { sample, imu, .. } => Some((*sample, *imu)),
            _ => None,
        });
        let moved: Vec<_> = moved.collect();
        let asked = ["subscribe to the IMU", "imu"].map(|name| taken.contains(&name));
        assert_eq!((asked, moved.len() > 50), ([imu; 2], imu), "{taken:?}");
        for ((due, movement), (next, _)) in moved.iter().zip(moved.iter().skip(1)) {
            assert_eq!(movement.quaternion(), [1.0, 0.0, 0.0, 0.0]);
            assert_eq!(movement.acceleration(), [0.0, 0.0, -1.0]);
            assert_eq!(movement.turn_rate(), [*due as f32 / 32.0, 0.0, 0.0]);
            assert_eq!(*next, due + 4);
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
        Output::Event(Event::Session { view, trouble }) => Some((view.phase, view.why, &**trouble)),
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
    engine.stored(1000.0, Stored::Refused("no folder".to_owned()));
    assert_eq!(view(&engine.take()), ("waiting", None, "no folder"));
    run(&mut engine, 1010, 1100);
    wish(&mut engine, 1100.0, 1, "begin");
    let written = run(&mut engine, 1110, 2000);
    assert!(lines(&written).count() > 5 && lines(&written).all(|lines| !lines.begins));
    // The disk is full, and has room again.
    for why in ["full", "still full"] {
        engine.stored(2000.0, Stored::Failed(HoldReason::Disk, why.to_owned()));
    }
    let held = ("held", Some(HoldReason::Disk), "full");
    assert_eq!(view(&engine.take()), held);
    engine.stored(2000.0, Stored::Written);
    assert_eq!(view(&engine.take()), ("held", Some(HoldReason::Disk), ""));
    wish(&mut engine, 2010.0, 1, "begin");
    // It was moved, which is told until the person goes on.
    engine.stored(2020.0, Stored::Anew("moved".to_owned()));
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
            Output::Answer(viewer, Event::Refused { text, .. }) => Some((*viewer, *text)),
            _ => None,
        })
    };
    wish(&mut engine, 1000.0, 1, "begin");
    let watched = wish(&mut engine, 1000.0, 2, "finish");
    assert_eq!(refused(&watched), Some((2, WATCHES)));
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
    engine.stored(100.0, Stored::Failed(HoldReason::Disk, "full".to_owned()));
    assert_eq!(engine.lead_unattended(100.0), Err("full".to_owned()));
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
    engine.connected(0.0);
    engine.take();
    let set = AlignCommand::Set(Alignment::new(2, true));
    let line = Command::Align(set).to_string();
    assert_eq!(place(&mut engine, 2), [Output::Line { line }]);
    // There are eight places, and no session.
    let refused = |outputs: &[Output], why| matches!(outputs, [Output::Answer(1, Event::Refused { text, .. })] if *text == why);
    assert!(refused(&place(&mut engine, 8), UNKNOWN));
    assert!(refused(&wish(&mut engine, 0.0, 1, "begin"), NO_SESSION));
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
                    let mut reader = CommandReader::new();
                    let command = line.bytes().find_map(|byte| reader.push(byte));
                    // On the heap, which aligns it as a model requires.
                    let file = SHIPPED.to_vec();
                    let checksum = Model::parse(&file).unwrap().checksum;
                    heard += &match command.unwrap().unwrap() {
                        Command::Identify => Answer::Identity(Identity {
                            model: Some(checksum),
                            version: "0.1.0",
                            revision: "0123456789ab",
                            image: "test",
                            armband: None,
                            firmware: None,
                            battery: None,
                        }),
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
    let file = SHIPPED.to_vec();
    let refused = engine.install(0.0, &file[..999]);
    assert_eq!(refused, Ok(()));
    let state = |outputs: &[Output]| match outputs {
        [Output::Event(Event::Installing(state))] => (state.state, state.text.clone()),
        outputs => panic!("{outputs:?}"),
    };
    let (failed, why) = state(&engine.take());
    assert!(
        failed == "failed" && why.starts_with("no board can run this file"),
        "{why}"
    );
    // Nothing is sent before the port is open, or while it is lost.
    engine.install(0.0, &file).unwrap();
    assert_eq!(state(&engine.take()).0, "running");
    engine.tick(40_000.0);
    assert_eq!(engine.take(), []);
    for begun in [40_000.0, 60_000.0] {
        engine.connected(begun);
        let (states, begins) = answer(&mut engine, begun, Ok(InstallationProgress::Next(0)));
        assert_eq!(begins, 1);
        assert!(states.iter().all(|state| state.state == "running"));
        engine.lost(begun, "pulled".to_owned(), Vec::new());
        engine.take();
    }
    engine.connected(61_000.0);
    let (states, _) = answer(&mut engine, 61_000.0, Ok(InstallationProgress::Installed));
    let last = states.last().unwrap();
    assert_eq!((last.state, last.blocks, last.of), ("done", 100, 100));
    // A board that is lost for good is given up, and one that refuses has its words.
    engine.install(62_000.0, &file).unwrap();
    answer(&mut engine, 62_000.0, Ok(InstallationProgress::Next(0)));
    engine.lost(62_000.0, "pulled".to_owned(), Vec::new());
    engine.take();
    engine.tick(93_000.0);
    assert_eq!(state(&engine.take()).0, "failed");
    engine.connected(94_000.0);
    engine.install(94_000.0, &file).unwrap();
    let (states, _) = answer(&mut engine, 94_000.0, Err(Refusal::Length));
    let last = states.last().unwrap();
    assert!(last.text.starts_with("the board refuses: "), "{last:?}");
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
        assert!(matches!(
            &outputs[..],
            [Output::Answer(1, Event::Refused { text: UNKNOWN, .. })]
        ));
    }
    let refused = said(r#"{"do":"bind"}"#);
    assert!(matches!(
        &refused[..],
        [Output::Answer(1, Event::Refused { text: NO_BOARD, .. })]
    ));
}
