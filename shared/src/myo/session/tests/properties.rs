//! The session's guarantees under random events in random order.

use super::{ANY, NEAR, address, advertisement, everything};
use crate::myo::characteristic::{Characteristic, Found};
use crate::myo::{Action, Event, Following, MyoSession, Phase, Settings};
use crate::units::Millis;
use alloc::{vec, vec::Vec};
use proptest::prelude::*;

/// A random event with its bytes. `Answer` is the successful answer to the outstanding operation, so
/// that random walks get beyond the first step.
#[derive(Clone, Debug)]
enum Random {
    Advertisement(u8, i8, Vec<u8>),
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
    Pair,
    Bind(Option<u8>),
}

fn characteristic() -> impl Strategy<Value = Characteristic> {
    prop::sample::select(&Characteristic::ALL[..])
}

fn random_event() -> impl Strategy<Value = Random> {
    let bytes = || prop::collection::vec(any::<u8>(), 0..24);
    prop_oneof![
        1 => (any::<u8>(), any::<i8>(), bytes()).prop_map(|(a, r, d)| Random::Advertisement(a, r, d)),
        3 => (0..4u8, any::<i8>()).prop_map(|(a, r)| Random::Armband(a, r)),
        40 => Just(Random::Answer),
        30 => any::<u8>().prop_map(Random::Emg),
        1 => Just(Random::ScanEnded),
        1 => Just(Random::Connected),
        1 => Just(Random::ConnectFailed),
        1 => prop::collection::vec(characteristic(), 0..8).prop_map(Random::Discovered),
        1 => bytes().prop_map(Random::Read),
        1 => Just(Random::Done),
        1 => Just(Random::Failed),
        2 => (characteristic(), bytes()).prop_map(|(c, b)| Random::Notification(c, b)),
        1 => Just(Random::Disconnected),
        10 => Just(Random::Tick),
        1 => Just(Random::Pair),
        1 => prop::option::of(0..4u8).prop_map(Random::Bind),
    ]
}

/// Milliseconds between events: mostly few, sometimes many, rarely a nonsensical clock.
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

/// The view of radio and pipeline: checks the order of actions.
#[derive(Default)]
struct Checker {
    outstanding: Option<Action>,
    /// Whether samples may be delivered: the mode was written and the stream has not ended.
    stream: bool,
    streams: u32,
    ended: u32,
}

impl Checker {
    /// The successful answer to the outstanding operation.
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
                self.ended += 1;
            }
            _ => {}
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn any_events_at_any_time_keep_the_guarantees(
        events in prop::collection::vec((pause(), random_event()), 0..300),
        (pinned, bound, follow_strongest) in any::<(bool, bool, bool)>(),
    ) {
        let pinned = pinned.then_some(NEAR);
        let bound = bound.then_some(address(2));
        let mut session = MyoSession::new(Settings { pinned, bound, follow_strongest, ..ANY });
        let mut checker = Checker::default();
        let mut now = Millis(0);
        let mut number = 0u8;
        let armband = advertisement();
        for (pause, random) in &events {
            now = now.plus(*pause);
            let mut value = [0; 16];
            let event = match random {
                Random::Advertisement(last, rssi, data) => {
                    Event::Advertisement { address: address(*last), rssi: *rssi, data }
                }
                Random::Armband(last, rssi) => {
                    Event::Advertisement { address: address(*last), rssi: *rssi, data: &armband }
                }
                Random::Answer => checker.answer(),
                Random::Emg(content) => {
                    value.fill(*content);
                    number = number.wrapping_add(1);
                    let characteristic = Characteristic::ALL[2 + usize::from(number % 4)];
                    Event::Notification { characteristic, bytes: &value }
                }
                Random::ScanEnded => Event::ScanEnded,
                Random::Connected => Event::Connected,
                Random::ConnectFailed => Event::ConnectFailed,
                Random::Discovered(these) => {
                    Event::Discovered(these.iter().copied().collect::<Found>())
                }
                Random::Read(bytes) => Event::Read(bytes),
                Random::Done => Event::Done,
                Random::Failed => Event::Failed,
                Random::Notification(characteristic, bytes) => {
                    Event::Notification { characteristic: *characteristic, bytes }
                }
                Random::Disconnected => Event::Disconnected,
                Random::Tick => Event::Tick,
                Random::Pair => Event::Pair,
                Random::Bind(last) => Event::Bind(last.map(address)),
            };
            let streamed = session.phase() == Phase::Streaming;
            let mut actions = Vec::new();
            session.handle(now, event, &mut |action| actions.push(action));

            // All held notifications, each with a gap before it, and one action that was due.
            prop_assert!(actions.len() <= 2 * 27 + 4);
            checker.event(event);
            let streams = session.phase() == Phase::Streaming;
            if (streams || actions.contains(&Action::StreamEnded)) && !streamed {
                checker.stream = true;
                checker.streams += 1;
            }
            for action in actions {
                if let Action::Connect(armband) = action {
                    let wanted = session.following().address();
                    prop_assert!(wanted.is_none_or(|wanted| wanted.bytes == armband.bytes));
                    prop_assert!(wanted.is_some() || session.following() == Following::Strongest);
                }
                checker.action(action)?;
            }
            prop_assert_eq!(checker.stream, streams);
            prop_assert_ne!(session.phase(), Phase::Idle);
        }
        prop_assert_eq!(checker.ended + u32::from(checker.stream), checker.streams);
    }
}

#[test]
fn random_walks_do_reach_a_stream() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    // Otherwise the property above would hold without a stream.
    let mut runner = TestRunner::deterministic();
    let walk = prop::collection::vec((0..30u32, random_event()), 300);
    let mut streamed = 0;
    for _ in 0..50 {
        let walk = walk.new_tree(&mut runner).unwrap().current();
        let mut session = MyoSession::new(ANY);
        let mut checker = Checker::default();
        let mut now = Millis(0);
        let armband = advertisement();
        for (pause, random) in walk {
            now = now.plus(pause);
            let event = match random {
                Random::Armband(last, rssi) => Event::Advertisement {
                    address: address(last),
                    rssi,
                    data: &armband,
                },
                Random::Answer => checker.answer(),
                _ => Event::Tick,
            };
            checker.event(event);
            session.handle(now, event, &mut |action| {
                if OPERATIONS(&action) {
                    checker.outstanding = Some(action);
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
