//! Evidence that the radio makes progress, for a watchdog that restarts a board whose radio does not.

use super::event::MyoEvent;
use super::session::{MyoSession, Phase};
use crate::units::Millis;

/// Milliseconds without an answer after which the Bluetooth stack counts as stopped.
const SILENT_MS: u32 = 60_000;
/// Consecutive streams without a notification after which notifications count as lost on this side.
const EMPTY_STREAMS: u8 = 3;

/// Decides whether a session makes progress: packets are taken, or the stack at least answers.
///
/// Whatever the session asks for, the stack has to answer within a minute, from the first question on: a scan is begun
/// anew every few seconds, and that needs no other device. What came over the air has to come again within a minute too, but
/// not before the first time: in a place without any Bluetooth device a restart would change nothing. Streams
/// without a notification do not count before the first stream that worked: an armband that hangs looks the same, and costs
/// one restart at most.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct RadioProgress {
    /// Since when the stack owes an answer: its last one, or the first question. None while nothing is asked.
    answered: Option<Millis>,
    /// Time of the last reception over the air; none before the first.
    heard: Option<Millis>,
    /// Notifications so far.
    notifications: u32,
    /// Whether a stream runs.
    streaming: bool,
    /// Whether a notification of it was taken.
    taken: bool,
    /// Streams without a notification since the last one with.
    empty: u8,
}

impl RadioProgress {
    /// Takes note of an event, after the session has handled it at `now`.
    pub fn handled(&mut self, now: Millis, event: MyoEvent<'_>, session: &MyoSession) {
        match event {
            MyoEvent::Advertisement { .. }
            | MyoEvent::Connected
            | MyoEvent::Discovered(_)
            | MyoEvent::Read(_)
            | MyoEvent::Done
            | MyoEvent::Notification { .. } => {
                self.heard = Some(now);
                self.answered = Some(now);
            }
            MyoEvent::Answered => self.answered = Some(now),
            // The driver itself sends these, or they end an operation that never began.
            MyoEvent::ScanEnded
            | MyoEvent::ConnectFailed
            | MyoEvent::Failed
            | MyoEvent::Disconnected
            | MyoEvent::Pair
            | MyoEvent::Bind(_)
            | MyoEvent::Tick => {}
        }
        if matches!(session.phase(), Phase::Idle | Phase::Unbound) {
            // Nothing is asked of the stack, so it has nothing to say.
            (self.answered, self.heard) = (None, None);
        } else if self.answered.is_none() {
            self.answered = Some(now);
        }
        let notifications = session.counters().notifications;
        if notifications != self.notifications {
            self.notifications = notifications;
            self.taken = true;
            self.empty = 0;
        }
        let streaming = session.phase() == Phase::Streaming;
        if self.streaming && !streaming {
            if !self.taken && notifications > 0 {
                self.empty = self.empty.saturating_add(1);
            }
            self.taken = false;
        }
        self.streaming = streaming;
    }

    /// Whether there is progress at `now`.
    #[must_use]
    pub fn is_alive(&self, now: Millis) -> bool {
        let silent = |last: &Millis| now.elapsed_since(*last) >= SILENT_MS;
        let is_silent = [self.answered, self.heard].iter().flatten().any(silent);
        self.empty < EMPTY_STREAMS && !is_silent
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::myo::session::tests::{ANY, FIRMWARE, address, advertisement, everything};
    use crate::myo::{Characteristic, Lane, Settings};

    /// A session whose every operation succeeds at once, and what its watchdog thinks of it.
    struct Link {
        session: MyoSession,
        progress: RadioProgress,
        now: Millis,
    }

    impl Link {
        fn new() -> Self {
            Self {
                session: MyoSession::new(ANY),
                progress: RadioProgress::default(),
                now: Millis(0),
            }
        }

        fn handle(&mut self, event: MyoEvent<'_>) {
            self.session.handle(self.now, event, &mut |_| {});
            self.progress.handled(self.now, event, &self.session);
        }

        fn advertise(&mut self) {
            self.handle(MyoEvent::Advertisement {
                address: address(1),
                rssi: -40,
                data: &advertisement(),
            });
        }

        fn notify(&mut self) {
            let characteristic = Characteristic::Emg(Lane::ALL[0]);
            self.handle(MyoEvent::Notification {
                characteristic,
                bytes: &[0; 16],
            });
        }

        /// A stream from the scan to its end a second later, with or without notifications.
        fn stream(&mut self, notified: bool) {
            while self.session.phase() != Phase::Streaming {
                self.now = self.now.plus(50);
                match self.session.phase() {
                    Phase::Scanning => self.advertise(),
                    Phase::Connecting => self.handle(MyoEvent::Connected),
                    Phase::SettingUp => {
                        self.handle(MyoEvent::Discovered(everything()));
                        self.handle(MyoEvent::Read(&FIRMWARE));
                        self.handle(MyoEvent::Read(&[80]));
                        (0..9).for_each(|_| self.handle(MyoEvent::Done));
                    }
                    _ => {}
                }
                self.handle(MyoEvent::Tick);
            }
            if notified {
                self.notify();
            }
            while self.session.phase() == Phase::Streaming {
                self.now = self.now.plus(50);
                self.handle(MyoEvent::Tick);
                self.handle(MyoEvent::Done);
            }
            self.handle(MyoEvent::Disconnected);
        }

        fn is_alive(&self) -> bool {
            self.progress.is_alive(self.now)
        }
    }

    #[test]
    fn three_empty_streams_after_one_that_worked_are_no_progress() {
        let mut link = Link::new();
        link.stream(true);
        for _ in 0..2 {
            link.stream(false);
            assert!(link.is_alive());
        }
        link.stream(false);
        assert!(!link.is_alive());
        link.stream(true);
        assert!(link.is_alive());
        link.stream(false);
        assert!(link.is_alive());
    }

    #[test]
    fn empty_streams_before_the_first_that_worked_change_nothing() {
        let mut link = Link::new();
        (0..10).for_each(|_| link.stream(false));
        assert!(link.is_alive());
    }

    #[test]
    fn a_stack_of_which_nothing_is_asked_may_stay_silent() {
        let mut link = Link::new();
        link.session = MyoSession::new(Settings {
            bound: Some(address(1)),
            ..Settings::default()
        });
        link.handle(MyoEvent::Tick);
        link.advertise();
        link.handle(MyoEvent::Disconnected);
        link.handle(MyoEvent::Bind(None));
        link.now = link.now.plus(1000);
        link.handle(MyoEvent::Tick);
        assert_eq!(link.session.phase(), Phase::Unbound);
        link.now = link.now.plus(2 * SILENT_MS);
        assert!(link.is_alive());
    }

    #[test]
    fn a_stack_that_is_never_heard_is_dead_a_minute_after_it_was_asked() {
        let mut link = Link::new();
        link.now = Millis(u32::MAX - 10_000);
        link.handle(MyoEvent::Tick);
        assert_eq!(link.session.phase(), Phase::Scanning);
        link.now = link.now.plus(SILENT_MS - 1);
        link.handle(MyoEvent::Tick);
        assert!(link.is_alive());
        link.now = link.now.plus(1);
        link.handle(MyoEvent::Tick);
        assert!(!link.is_alive());
    }

    #[test]
    fn a_stack_that_answers_where_nothing_is_heard_stays_alive() {
        let mut link = Link::new();
        link.handle(MyoEvent::Tick);
        for _ in 0..100 {
            link.now = link.now.plus(SILENT_MS - 1);
            link.handle(MyoEvent::Tick);
            assert!(link.is_alive());
            link.handle(MyoEvent::Answered);
        }
        // Nor do scans that it refuses keep it alive.
        for _ in 0..20 {
            link.now = link.now.plus(SILENT_MS / 10);
            link.handle(MyoEvent::Tick);
            link.handle(MyoEvent::ScanEnded);
        }
        assert!(!link.is_alive());
    }

    #[test]
    fn answers_do_not_stand_for_what_was_heard() {
        let mut link = Link::new();
        link.handle(MyoEvent::Tick);
        link.advertise();
        link.handle(MyoEvent::ConnectFailed);
        for _ in 0..6 {
            assert!(link.is_alive());
            link.now = link.now.plus(10_000);
            link.handle(MyoEvent::Answered);
        }
        assert!(!link.is_alive());
    }

    #[test]
    fn a_stack_that_was_heard_and_falls_silent_is_dead_after_a_minute() {
        let mut link = Link::new();
        link.now = Millis(10_000_000);
        link.handle(MyoEvent::Tick);
        link.advertise();
        link.now = link.now.plus(SILENT_MS - 1);
        link.handle(MyoEvent::Tick);
        link.handle(MyoEvent::ConnectFailed);
        assert!(link.is_alive());
        link.now = link.now.plus(1);
        link.handle(MyoEvent::Tick);
        assert!(!link.is_alive());
        link.advertise();
        assert!(link.is_alive());
    }
}
