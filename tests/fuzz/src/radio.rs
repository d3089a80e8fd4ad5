//! Session with armbands as its radio sees it, and the conditions that hold of its actions.

use shared::myo::{
    Action, Address, AddressKind, Characteristic, Following, Found, MyoEvent, MyoSession, Phase,
    RadioProgress, Settings, Uuid,
};
use shared::stream::link_sequence::{QueueGapDetector, Sequencer};
use shared::units::Millis;

/// Largest number of actions of an event: the notifications that a session holds back, and the others of one event.
const MOST_ACTIONS: usize = 2 * 27 + 4;
const EMG_BYTES: usize = 16;

pub const fn address(last: u8) -> Address {
    Address {
        kind: AddressKind::Public,
        bytes: [last, 0, 0, 0, 0, 0xfa],
    }
}

pub fn advertisement() -> [u8; 18] {
    let mut data = [0; 18];
    data[..2].copy_from_slice(&[17, 0x06]);
    data[2..].copy_from_slice(&Uuid::CONTROL.to_le_bytes());
    data
}

pub fn everything() -> Found {
    Characteristic::ALL.into_iter().collect()
}

/// Session with its clock and the checks of its actions.
pub struct FuzzLink {
    pub session: MyoSession,
    now: Millis,
    progress: RadioProgress,
    /// Operation that has no answer yet.
    outstanding: Option<Action>,
    /// True if samples may be delivered.
    stream: bool,
    /// Number of the next EMG notification, which is in its bytes.
    number: u64,
    /// True for each number whose notification was delivered.
    delivered: Vec<bool>,
    /// Actions of the newest event; kept, so that not every event allocates.
    actions: Vec<Action>,
    lost: u64,
    sequencer: Sequencer,
    detector: QueueGapDetector,
    /// Number of samples delivered and missing so far.
    position: u32,
}

impl FuzzLink {
    /// Creates a session before its first event, at any time of the clock.
    pub fn new(settings: Settings, now: u32) -> Self {
        Self {
            session: MyoSession::new(settings),
            now: Millis(now),
            progress: RadioProgress::default(),
            outstanding: None,
            stream: false,
            number: 0,
            delivered: Vec::new(),
            actions: Vec::new(),
            lost: 0,
            sequencer: Sequencer::default(),
            detector: QueueGapDetector::default(),
            position: 0,
        }
    }

    /// Creates a session that streams.
    pub fn streaming(now: u32) -> Self {
        let mut link = Self::new(
            Settings {
                bound: Some(address(1)),
                ..Settings::default()
            },
            now,
        );
        link.handle(MyoEvent::Tick);
        link.advertise(1, -40, &advertisement());
        while link.session.phase() != Phase::Streaming {
            link.answer();
        }
        link
    }

    pub fn wait(&mut self, milliseconds: u32) {
        self.now = self.now.plus(milliseconds);
    }

    /// Passes an advertisement to the session.
    pub fn advertise(&mut self, last: u8, rssi: i8, data: &[u8]) {
        let address = address(last);
        self.handle(MyoEvent::Advertisement {
            address,
            rssi,
            data,
        });
    }

    /// Lets the outstanding operation succeed.
    pub fn answer(&mut self) {
        self.handle(match self.outstanding {
            Some(Action::Connect(_)) => MyoEvent::Connected,
            Some(Action::Discover) => MyoEvent::Discovered(everything()),
            Some(Action::Read(_)) => MyoEvent::Read(&[1, 0, 5, 0, 0, 0, 2, 0]),
            Some(_) => MyoEvent::Done,
            None => MyoEvent::Tick,
        });
    }

    /// Passes an EMG notification of a lane, with a number of its own inside.
    pub fn emg(&mut self, lane: usize) {
        let mut bytes = [0x55; EMG_BYTES];
        bytes[..8].copy_from_slice(&self.number.to_le_bytes());
        self.number += 1;
        self.delivered.push(false);
        self.handle(MyoEvent::Notification {
            characteristic: Characteristic::ALL[2 + lane % 4],
            bytes: &bytes,
        });
    }

    /// Passes an event on and checks the session's actions.
    pub fn handle(&mut self, event: MyoEvent<'_>) {
        let streamed = self.session.phase() == Phase::Streaming;
        let mut actions = std::mem::take(&mut self.actions);
        self.session
            .handle(self.now, event, &mut |action| actions.push(action));
        assert!(actions.len() <= MOST_ACTIONS, "{} actions", actions.len());
        self.progress.handled(self.now, event, &self.session);
        let _ = self.progress.is_alive(self.now);

        if is_answer(self.outstanding, event) {
            self.outstanding = None;
        }
        let streams = self.session.phase() == Phase::Streaming;
        self.stream |= streams || (actions.contains(&Action::StreamEnded) && !streamed);
        for action in actions.drain(..) {
            self.act(action);
        }
        self.actions = actions;
        assert_eq!(self.stream, streams, "every stream ends once");
        assert_ne!(self.session.phase(), Phase::Idle);
        let lost = u64::from(self.session.counters().lost);
        assert_eq!(
            lost,
            self.lost.min(u64::from(u32::MAX)),
            "the counter of lost samples"
        );
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::Connect(armband) => {
                let followed = self.session.following();
                let wanted = followed.address();
                assert!(wanted.is_none_or(|wanted| wanted.bytes == armband.bytes));
                assert!(wanted.is_some() || followed == Following::Strongest);
                self.operation(action);
            }
            Action::Discover | Action::Read(_) | Action::Subscribe(_) => self.operation(action),
            Action::Write(_, payload) => {
                assert!(!payload.as_slice().is_empty());
                self.operation(action);
            }
            Action::Disconnect => self.outstanding = None,
            Action::Deliver(pair) => {
                assert!(self.stream, "samples outside a stream");
                let number = pair[0].map(i8::cast_unsigned);
                let is_numbered = pair[1] == [0x55; 8];
                let number = usize::try_from(u64::from_le_bytes(number));
                // A number beyond them comes from the input, not from [`Self::emg`].
                if let (true, Ok(number)) = (is_numbered, number)
                    && let Some(delivered) = self.delivered.get_mut(number)
                {
                    assert!(!*delivered, "delivered twice");
                    *delivered = true;
                }
                let packet = self.sequencer.samples(pair);
                assert_eq!(packet.first.0, self.position, "positions never go back");
                let received = self.detector.receive(packet);
                assert_eq!((received.missing, received.samples), (0, Some(pair)));
                self.position = self.position.wrapping_add(2);
            }
            Action::Gap { missing } => {
                assert!(self.stream && missing > 0);
                self.lost += u64::from(missing);
                self.sequencer.gap(missing);
                // The queue's other end finds the gap by itself; this detector starts anew.
                self.detector = QueueGapDetector::default();
                let mut skipped = self.sequencer;
                let first = skipped.end().first;
                assert_eq!(
                    first.since(shared::units::SampleIndex(self.position)),
                    missing
                );
                self.position = first.0;
                self.detector.receive(skipped.end());
            }
            Action::StreamEnded => {
                assert!(self.stream);
                self.stream = false;
                let packet = self.sequencer.end();
                assert!(self.detector.receive(packet).disconnected);
            }
            Action::Imu(_) => assert!(self.stream, "movement outside a stream"),
            Action::Keep(armband) => assert_eq!(armband, self.session.bound()),
            Action::Scan | Action::StopScan => {}
        }
    }

    /// Takes a new operation: at most one is outstanding.
    fn operation(&mut self, action: Action) {
        assert_eq!(self.outstanding, None, "and then {action:?}");
        self.outstanding = Some(action);
    }
}

/// Returns true if an event ends an operation.
fn is_answer(outstanding: Option<Action>, event: MyoEvent<'_>) -> bool {
    matches!(
        (outstanding, event),
        (
            Some(Action::Connect(_)),
            MyoEvent::Connected | MyoEvent::ConnectFailed
        ) | (
            Some(Action::Discover),
            MyoEvent::Discovered(_) | MyoEvent::Failed
        ) | (Some(Action::Read(_)), MyoEvent::Read(_) | MyoEvent::Failed)
            | (
                Some(Action::Subscribe(_) | Action::Write(..)),
                MyoEvent::Done | MyoEvent::Failed
            )
            | (_, MyoEvent::Disconnected)
    )
}
