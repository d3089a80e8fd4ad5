//! Whatever happens, in whatever order: the promises hold.

use super::{NEAR, address, advertisement, everything};
use crate::myo::characteristic::{Characteristic, Found};
use crate::myo::{Action, Event, MyoSession, Phase, Settings};
use crate::units::Millis;
use alloc::{vec, vec::Vec};
use proptest::prelude::*;

/// An event with its bytes. `Answer` is whatever answers the outstanding operation well, so that
/// random walks get beyond the first step.
#[derive(Clone, Debug)]
enum Happening {
    Heard(u8, i8, Vec<u8>),
    Armband(u8, i8),
    Answer,
    Emg(u8),
    ScanEnded,
    Connected,
    ConnectFailed,
    Discovered(Vec<Characteristic>),
    Read(Vec<u8>),
    Done,
    Failed,
    Notification(Characteristic, Vec<u8>),
    Disconnected,
    Tick,
}

fn characteristic() -> impl Strategy<Value = Characteristic> {
    prop::sample::select(&Characteristic::ALL[..])
}

fn happening() -> impl Strategy<Value = Happening> {
    let bytes = || prop::collection::vec(any::<u8>(), 0..24);
    prop_oneof![
        1 => (any::<u8>(), any::<i8>(), bytes()).prop_map(|(a, r, d)| Happening::Heard(a, r, d)),
        3 => (0..4u8, any::<i8>()).prop_map(|(a, r)| Happening::Armband(a, r)),
        40 => Just(Happening::Answer),
        30 => any::<u8>().prop_map(Happening::Emg),
        1 => Just(Happening::ScanEnded),
        1 => Just(Happening::Connected),
        1 => Just(Happening::ConnectFailed),
        1 => prop::collection::vec(characteristic(), 0..8).prop_map(Happening::Discovered),
        1 => bytes().prop_map(Happening::Read),
        1 => Just(Happening::Done),
        1 => Just(Happening::Failed),
        2 => (characteristic(), bytes()).prop_map(|(c, b)| Happening::Notification(c, b)),
        1 => Just(Happening::Disconnected),
        10 => Just(Happening::Tick),
    ]
}

/// Milliseconds that pass: mostly few, at times many, and now and then the clock is nonsense.
fn pause() -> impl Strategy<Value = u32> {
    prop_oneof![20 => 0..30u32, 5 => 0..700u32, 2 => 0..12_000u32, 1 => any::<u32>()]
}

const OPERATIONS: fn(&Action) -> bool = |action| {
    matches!(
        action,
        Action::Connect(_)
            | Action::Discover
            | Action::Read(_)
            | Action::Subscribe(_)
            | Action::Write(..)
    )
};

/// What a radio knows, and what a pipeline may expect.
#[derive(Default)]
struct Judge {
    outstanding: Option<Action>,
    /// Whether samples may come: the mode was written and the stream is not lost.
    stream: bool,
    streams: u32,
    lost: u32,
}

impl Judge {
    /// The event that answers the outstanding operation well.
    fn answer(&self) -> Event<'static> {
        match self.outstanding {
            Some(Action::Connect(_)) => Event::Connected,
            Some(Action::Discover) => Event::Discovered(everything()),
            Some(Action::Read(_)) => Event::Read(&[1, 0, 5, 0, 0, 0, 2, 0]),
            Some(_) => Event::Done,
            None => Event::Tick,
        }
    }

    fn event(&mut self, event: Event<'_>) {
        let over = matches!(
            (self.outstanding, event),
            (
                Some(Action::Connect(_)),
                Event::Connected | Event::ConnectFailed
            ) | (Some(Action::Discover), Event::Discovered(_) | Event::Failed)
                | (Some(Action::Read(_)), Event::Read(_) | Event::Failed)
                | (
                    Some(Action::Subscribe(_) | Action::Write(..)),
                    Event::Done | Event::Failed
                )
                | (_, Event::Disconnected)
        );
        if over {
            self.outstanding = None;
        }
    }

    fn action(&mut self, action: Action) -> Result<(), TestCaseError> {
        if OPERATIONS(&action) {
            prop_assert_eq!(self.outstanding, None, "and then {:?}", action);
            self.outstanding = Some(action);
        }
        match action {
            Action::Disconnect => self.outstanding = None,
            Action::Deliver(_) => prop_assert!(self.stream),
            Action::Gap { missing } => prop_assert!(self.stream && missing > 0),
            Action::StreamEnded => {
                prop_assert!(self.stream);
                self.stream = false;
                self.lost += 1;
            }
            _ => {}
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_events_at_any_time_keep_the_promises(
        happenings in prop::collection::vec((pause(), happening()), 0..300),
        pinned: bool,
    ) {
        let pinned = pinned.then_some(NEAR);
        let mut session = MyoSession::new(Settings { pinned, ..Settings::default() });
        let mut judge = Judge::default();
        let mut now = Millis(0);
        let mut number = 0u8;
        let armband = advertisement();
        for (pause, happening) in &happenings {
            now = now.plus(*pause);
            let mut value = [0; 16];
            let event = match happening {
                Happening::Heard(last, rssi, data) => {
                    Event::Advertisement { address: address(*last), rssi: *rssi, data }
                }
                Happening::Armband(last, rssi) => {
                    Event::Advertisement { address: address(*last), rssi: *rssi, data: &armband }
                }
                Happening::Answer => judge.answer(),
                Happening::Emg(content) => {
                    value.fill(*content);
                    number = number.wrapping_add(1);
                    let characteristic = Characteristic::ALL[2 + usize::from(number % 4)];
                    Event::Notification { characteristic, bytes: &value }
                }
                Happening::ScanEnded => Event::ScanEnded,
                Happening::Connected => Event::Connected,
                Happening::ConnectFailed => Event::ConnectFailed,
                Happening::Discovered(these) => {
                    Event::Discovered(these.iter().copied().collect::<Found>())
                }
                Happening::Read(bytes) => Event::Read(bytes),
                Happening::Done => Event::Done,
                Happening::Failed => Event::Failed,
                Happening::Notification(characteristic, bytes) => {
                    Event::Notification { characteristic: *characteristic, bytes }
                }
                Happening::Disconnected => Event::Disconnected,
                Happening::Tick => Event::Tick,
            };
            let streamed = session.phase() == Phase::Streaming;
            let mut actions = Vec::new();
            session.handle(now, event, &mut |action| actions.push(action));

            // All that was held, each with a gap before it, and one thing that was due.
            prop_assert!(actions.len() <= 2 * 27 + 2);
            judge.event(event);
            let streams = session.phase() == Phase::Streaming;
            if (streams || actions.contains(&Action::StreamEnded)) && !streamed {
                judge.stream = true;
                judge.streams += 1;
            }
            for action in actions {
                judge.action(action)?;
            }
            prop_assert_eq!(judge.stream, streams);
            prop_assert_ne!(session.phase(), Phase::Idle);
        }
        prop_assert_eq!(judge.lost + u32::from(judge.stream), judge.streams);
    }
}

#[test]
fn random_walks_do_reach_a_stream() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    // Else the property above would hold for want of trying.
    let mut runner = TestRunner::deterministic();
    let walk = prop::collection::vec((0..30u32, happening()), 300);
    let mut streamed = 0;
    for _ in 0..50 {
        let walk = walk.new_tree(&mut runner).unwrap().current();
        let mut session = MyoSession::new(Settings::default());
        let mut judge = Judge::default();
        let mut now = Millis(0);
        let armband = advertisement();
        for (pause, happening) in walk {
            now = now.plus(pause);
            let event = match happening {
                Happening::Armband(last, rssi) => Event::Advertisement {
                    address: address(last),
                    rssi,
                    data: &armband,
                },
                Happening::Answer => judge.answer(),
                _ => Event::Tick,
            };
            judge.event(event);
            session.handle(now, event, &mut |action| {
                if OPERATIONS(&action) {
                    judge.outstanding = Some(action);
                }
            });
            if session.phase() == Phase::Streaming {
                streamed += 1;
                break;
            }
        }
    }
    assert!(streamed > 25, "{streamed} of 50");
}
