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
    use crate::myo::Settings;
    use crate::myo::session::tests::{ANY, Driver, NEAR};

    fn is_alive(driver: &Driver, now: u32) -> bool {
        driver.progress.is_alive(Millis(now))
    }

    /// A stream from the scan to its end, with or without a notification; returns when the next scan is due.
    fn stream(driver: &mut Driver, now: u32, notified: bool) -> u32 {
        driver.streaming(now);
        let mut now = now + 501;
        if notified {
            driver.emg(now, 0);
        }
        while driver.session.phase() == Phase::Streaming {
            now += 50;
            driver.handle(now, MyoEvent::Tick);
            driver.handle(now, MyoEvent::Done);
        }
        driver.handle(now, MyoEvent::Disconnected);
        now + 5_000
    }

    #[test]
    fn three_empty_streams_after_one_that_worked_are_no_progress() {
        let mut driver = Driver::new(ANY);
        let mut now = 0;
        for (notified, alive) in [
            (true, true),
            (false, true),
            (false, true),
            (false, false),
            (true, true),
            (false, true),
        ] {
            now = stream(&mut driver, now, notified);
            assert_eq!(is_alive(&driver, now), alive, "at {now} ms");
        }
    }

    #[test]
    fn empty_streams_before_the_first_that_worked_change_nothing() {
        let mut driver = Driver::new(ANY);
        let now = (0..10).fold(0, |now, _| stream(&mut driver, now, false));
        assert!(is_alive(&driver, now));
    }

    #[test]
    fn a_stack_of_which_nothing_is_asked_may_stay_silent() {
        let mut driver = Driver::new(Settings {
            bound: Some(NEAR),
            ..Settings::default()
        });
        driver.handle(0, MyoEvent::Tick);
        driver.advertise(0, NEAR, -40);
        driver.handle(0, MyoEvent::Disconnected);
        driver.handle(0, MyoEvent::Bind(None));
        driver.handle(1000, MyoEvent::Tick);
        assert_eq!(driver.session.phase(), Phase::Unbound);
        assert!(is_alive(&driver, 1000 + 2 * SILENT_MS));
    }

    #[test]
    fn a_stack_that_is_never_heard_is_dead_a_minute_after_it_was_asked() {
        let mut driver = Driver::new(ANY);
        let asked = u32::MAX - 10_000;
        driver.handle(asked, MyoEvent::Tick);
        assert_eq!(driver.session.phase(), Phase::Scanning);
        for (later, alive) in [(SILENT_MS - 1, true), (SILENT_MS, false)] {
            let now = asked.wrapping_add(later);
            driver.handle(now, MyoEvent::Tick);
            assert_eq!(is_alive(&driver, now), alive, "{later} ms later");
        }
    }

    #[test]
    fn a_stack_that_answers_where_nothing_is_heard_stays_alive() {
        let mut driver = Driver::new(ANY);
        driver.handle(0, MyoEvent::Tick);
        let mut now = 0;
        for _ in 0..100 {
            now += SILENT_MS - 1;
            driver.handle(now, MyoEvent::Tick);
            assert!(is_alive(&driver, now));
            driver.handle(now, MyoEvent::Answered);
        }
        // Nor do scans that it refuses keep it alive.
        for _ in 0..20 {
            now += SILENT_MS / 10;
            driver.handle(now, MyoEvent::Tick);
            driver.handle(now, MyoEvent::ScanEnded);
        }
        assert!(!is_alive(&driver, now));
    }

    #[test]
    fn answers_do_not_stand_for_what_was_heard() {
        let mut driver = Driver::new(ANY);
        driver.handle(0, MyoEvent::Tick);
        driver.advertise(0, NEAR, -40);
        driver.handle(0, MyoEvent::ConnectFailed);
        for now in (0..60_000).step_by(10_000) {
            assert!(is_alive(&driver, now));
            driver.handle(now + 10_000, MyoEvent::Answered);
        }
        assert!(!is_alive(&driver, 60_000));
    }

    #[test]
    fn a_stack_that_was_heard_and_falls_silent_is_dead_after_a_minute() {
        let mut driver = Driver::new(ANY);
        let heard = 10_000_000;
        driver.handle(heard, MyoEvent::Tick);
        driver.advertise(heard, NEAR, -40);
        let now = heard + SILENT_MS - 1;
        driver.handle(now, MyoEvent::Tick);
        driver.handle(now, MyoEvent::ConnectFailed);
        assert!(is_alive(&driver, now));
        driver.handle(now + 1, MyoEvent::Tick);
        assert!(!is_alive(&driver, now + 1));
        driver.advertise(now + 1, NEAR, -40);
        assert!(is_alive(&driver, now + 1));
    }
}
