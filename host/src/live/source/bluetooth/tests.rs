use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;

use serde_json::{Value, json};
use shared::myo::{Characteristic, Uuid};
use shared::units::{Millis, Sample, SampleIndex};
use tokio::sync::mpsc::error::TryRecvError;
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};

use super::*;
use crate::live::hub::Hub;
use crate::live::source::Stop;
use web::SHIPPED;
use web::radio::advertising_data;

const ADDRESS: &str = "FA:12:34:56:78:9A";
/// Firmware version 1.5.1970, hardware revision 2.
const FIRMWARE: [u8; 8] = [1, 0, 5, 0, 0xb2, 0x07, 2, 0];

/// Armband and stack, simulated.
struct Peripheral {
    actions: UnboundedReceiver<Action>,
    events: Sender<RadioEvent>,
    samples: Vec<Sample>,
    /// Number of notifications after which the link is lost, once.
    lost_after: Option<usize>,
    /// Notifications of the recording sent so far, over all connections.
    sent: usize,
    lane: usize,
    streams: bool,
    /// Whether its IMU is subscribed to, and on in its mode.
    imu: (bool, bool),
}

impl Peripheral {
    /// Answers actions, and streams between them, until the session ends. Returns the names of the actions.
    fn run(mut self) -> Vec<&'static str> {
        let mut actions_taken = Vec::new();
        loop {
            let action = if self.streams {
                self.actions.try_recv()
            } else {
                let action = self.actions.blocking_recv();
                action.ok_or(TryRecvError::Disconnected)
            };
            match action {
                Ok(action) => actions_taken.push(self.answer(action)),
                Err(TryRecvError::Empty) => self.notify(),
                Err(TryRecvError::Disconnected) => return actions_taken,
            }
        }
    }

    fn send(&self, event: RadioEvent) {
        // The session may have ended.
        let _ = self.events.send(event);
    }

    fn answer(&mut self, action: Action) -> &'static str {
        let (name, event) = match action {
            Action::Scan => ("scan", advertisement()),
            Action::StopScan => return "stop",
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
            Action::Disconnect => {
                self.streams = false;
                ("disconnect", RadioEvent::Disconnected)
            }
            other => panic!("{other:?} is for the pipeline"),
        };
        self.send(event);
        name
    }

    /// Sends the next samples of the recording, on the four characteristics in turn, and behind every second notification what
    /// the IMU says: its turn is the number of the notification.
    fn notify(&mut self) {
        let Some(pair) = self.samples.chunks_exact(2).nth(self.sent) else {
            self.streams = false;
            return;
        };
        let emg = pair.as_flattened().iter();
        self.send(RadioEvent::Notification {
            characteristic: Characteristic::ALL[2 + self.lane],
            bytes: emg.map(|&value| value.cast_unsigned()).collect(),
        });
        self.lane = (self.lane + 1) % 4;
        self.sent += 1;
        if self.imu == (true, true) && self.sent.is_multiple_of(2) {
            let imu = [16_384, 0, 0, 0, 0, 0, -2048, self.sent as i16, 0, 0].map(i16::to_le_bytes);
            self.send(RadioEvent::Notification {
                characteristic: Characteristic::Imu,
                bytes: imu.as_flattened().to_vec(),
            });
        }
        // Ten times as fast as a real armband.
        std::thread::sleep(Duration::from_millis(1));
        let is_last = |&mut after: &mut usize| after == self.sent;
        if self.lost_after.take_if(is_last).is_some() {
            self.send(RadioEvent::Disconnected);
            (self.lane, self.streams, self.imu) = (0, false, (false, false));
        }
    }
}

/// Advertisement like a real one: padded name, flags, and the service that is searched for.
fn advertisement() -> RadioEvent {
    RadioEvent::Advertisement {
        address: Address::parse(ADDRESS).unwrap(),
        rssi: -50,
        data: advertising_data([Uuid::CONTROL.to_le_bytes()]),
    }
}

/// Running session, until it is stopped.
struct Started {
    hub: Arc<Hub>,
    stop: Stop,
    session: JoinHandle<anyhow::Result<()>>,
    peripheral: JoinHandle<Vec<&'static str>>,
}

fn start(
    address: Option<Address>,
    imu: bool,
    samples: &[Sample],
    lost_after: Option<usize>,
) -> Started {
    let (actions, wanted) = unbounded_channel();
    let (sender, events) = mpsc::channel();
    let peripheral = Peripheral {
        actions: wanted,
        events: sender,
        samples: samples.to_vec(),
        lost_after,
        sent: 0,
        lane: 0,
        streams: false,
        imu: (false, false),
    };
    let peripheral = std::thread::spawn(move || peripheral.run());
    let (hub, stop) = (Arc::new(Hub::new()), Stop::default());
    let context = Context {
        hub: hub.clone(),
        requests: mpsc::channel().1,
        stop: stop.clone(),
        imu,
    };
    let armband = ArmbandSource {
        address,
        model: SHIPPED.to_vec(),
    };
    let session = std::thread::Builder::new()
        .stack_size(crate::live::STACK)
        .spawn(move || armband.run_on(&Radio { actions, events }, &context))
        .unwrap();
    Started {
        hub,
        stop,
        session,
        peripheral,
    }
}

/// Collects the messages of a hub, until it is dropped.
fn follow(hub: &Hub) -> Receiver<Value> {
    let mut following = hub.subscribe().following;
    let (sender, messages) = mpsc::channel();
    std::thread::spawn(move || {
        while let Ok(message) = following.blocking_recv() {
            let _ = sender.send(serde_json::from_str(&message).unwrap());
        }
    });
    messages
}

fn recording() -> Vec<Sample> {
    let options = recordings::synthetic::SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 12,
        ..Default::default()
    };
    recordings::synthetic::generate(&options).remove(0).samples
}

/// Instants and labels of the device's pipeline.
fn labels(samples: &[Sample]) -> Vec<Value> {
    let mut scored = ScoredPipeline::open(SHIPPED).unwrap();
    let reports = samples.iter().enumerate().flat_map(|(place, &sample)| {
        scored
            .sample(Millis(0), 0.0, SampleIndex(place as u32), sample)
            .reports
    });
    let shown = reports.map(|report| {
        let label = report.status.label().name();
        json!([report.instant.0, label, report.status.valid()])
    });
    shown.collect()
}

#[test]
fn an_armband_is_followed_and_labelled_as_on_a_board_and_found_again_when_it_is_lost() {
    let samples = recording();
    let half = samples.len() / 4;
    let started = start(None, false, &samples, Some(half));
    let messages = follow(&started.hub);
    let (mut emg, mut shown, mut connected) = (Vec::new(), Vec::new(), Vec::new());
    while emg.len() < samples.len() {
        let message = messages.recv_timeout(Duration::from_secs(60)).unwrap();
        match message["type"].as_str().unwrap() {
            "samples" => {
                let first = message["first"].as_u64().unwrap() as usize;
                assert_eq!(first, emg.len());
                let pair: Vec<Sample> = serde_json::from_value(message["emg"].clone()).unwrap();
                emg.extend(pair);
            }
            "report" => {
                shown.push(json!([
                    message["instant"],
                    message["label"],
                    message["valid"]
                ]));
            }
            "source" => connected.push(message["connected"] == true),
            "board" if message["battery"] == 80 => {
                assert!(message["armband"].is_null() || message["armband"] == ADDRESS);
            }
            _ => {}
        }
    }
    started.stop.request();
    started.session.join().unwrap().unwrap();
    let actions_taken = started.peripheral.join().unwrap();
    assert_eq!(emg, samples);
    // Labels of the first connection; the first report is of the state before it.
    let expected = labels(&samples[..2 * half]);
    assert!(expected.len() > 10, "{expected:?}");
    let first = shown.iter().skip_while(|report| **report != expected[0]);
    assert_eq!(
        first.take(expected.len()).cloned().collect::<Vec<_>>(),
        expected
    );
    connected.dedup();
    assert_eq!(connected, [false, true, false, true]);
    assert_eq!(
        actions_taken
            .iter()
            .filter(|name| **name == "connect")
            .count(),
        2
    );
    assert_eq!(actions_taken.last(), Some(&"disconnect"));
}

#[test]
fn an_armband_of_an_address_is_connected_to_at_its_first_advertisement() {
    let address = Address::parse(ADDRESS).unwrap();
    let samples = recording();
    let started = start(Some(address), false, &samples[..400], None);
    let messages = follow(&started.hub);
    let is_shown = |message: &Value| message["type"] == "samples" && message["first"] == 398;
    while !is_shown(&messages.recv_timeout(Duration::from_secs(60)).unwrap()) {}
    started.stop.request();
    started.session.join().unwrap().unwrap();
    let actions_taken = started.peripheral.join().unwrap();
    assert_eq!(actions_taken[..2], ["scan", "stop"]);
    assert!(actions_taken.contains(&"stream"), "{actions_taken:?}");
}

#[test]
fn movement_comes_where_it_is_wanted_numbered_by_the_sample_that_is_due() {
    let samples = &recording()[..400];
    for imu in [false, true] {
        let started = start(None, imu, samples, None);
        let messages = follow(&started.hub);
        let mut moved = Vec::new();
        loop {
            let message = messages.recv_timeout(Duration::from_secs(60)).unwrap();
            match message["type"].as_str().unwrap() {
                "samples" if message["first"] == 398 => break,
                "imu" => moved.push(message),
                _ => {}
            }
        }
        started.stop.request();
        started.session.join().unwrap().unwrap();
        let actions_taken = started.peripheral.join().unwrap();
        let asked = ["subscribe to the IMU", "imu"].map(|name| actions_taken.contains(&name));
        assert_eq!(
            (asked, moved.len() > 50),
            ([imu; 2], imu),
            "{actions_taken:?}"
        );
        for (message, next) in moved.iter().zip(moved.iter().skip(1)) {
            assert_eq!(message["quaternion"], json!([1.0, 0.0, 0.0, 0.0]));
            assert_eq!(message["acceleration"], json!([0.0, 0.0, -1.0]));
            let [due, later] = [message, next].map(|message| message["sample"].as_f64().unwrap());
            assert_eq!(message["turn_rate"], json!([due / 32.0, 0.0, 0.0]));
            assert_eq!(later, due + 4.0);
        }
    }
}

#[test]
fn an_adapter_that_is_gone_ends_the_session_with_its_reason() {
    let (actions, _wanted) = unbounded_channel();
    let (sender, events) = mpsc::channel();
    sender
        .send(RadioEvent::Gone("it is switched off".to_owned()))
        .unwrap();
    let context = Context {
        hub: Arc::new(Hub::new()),
        requests: mpsc::channel().1,
        stop: Stop::default(),
        imu: false,
    };
    let armband = ArmbandSource {
        address: None,
        model: SHIPPED.to_vec(),
    };
    let thread = std::thread::Builder::new().stack_size(crate::live::STACK);
    let session = thread.spawn(move || armband.run_on(&Radio { actions, events }, &context));
    let error = session.unwrap().join().unwrap().unwrap_err();
    assert!(error.to_string().contains("switched off"), "{error}");
}
