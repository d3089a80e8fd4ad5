//! Timers of a running stream: keep-alive, silence and unanswered writes; and its IMU, which is switched on and off while it
//! runs.

use super::IMU;
use crate::units::Millis;

/// Silence after which the mode is set again, and after which, once more, the connection is closed.
const SILENCE_MS: u32 = 500;
/// Milliseconds without a notification before the first one: an armband may begin three seconds after its mode is set, and anew if it is set again.
const START_MS: u32 = 4_000;
/// Period of the command never to sleep. The armband's own timer is about 30 s.
const NEVER_SLEEP_MS: u32 = 10_000;
/// Time-out of an operation.
pub(super) const OPERATION_MS: u32 = 5_000;

/// The times of a running stream.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct StreamMonitor {
    /// Time of the newest EMG; of the stream's begin, before the first notification.
    emg: Millis,
    /// Whether a notification has come, of whatever bytes.
    has_begun: bool,
    /// Time of the last command never to sleep.
    never_sleep: Millis,
    /// Time at which the mode was set again during the present silence.
    mode_set_again: Option<Millis>,
    /// Time of the request for the outstanding write.
    write: Option<Millis>,
    imu: Imu,
}

/// State of the IMU.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Imu {
    Unused,
    /// Subscribed to, and off in the armband's mode.
    Off,
    On,
}

/// Write that is due, if any.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Due {
    Nothing,
    /// Command the armband never to sleep.
    NeverSleep,
    /// Subscribe to its IMU.
    SubscribeImu,
    /// Set its mode, again or with another IMU.
    SetMode,
    /// Close the connection: still silent after the mode was set again.
    Stalled,
    /// Close the connection: a write was not answered.
    Unanswered,
}

impl StreamMonitor {
    /// A stream that begins; `write` where the mode's confirmation is still to come.
    pub(super) const fn new(now: Millis, write: Option<Millis>) -> Self {
        Self {
            emg: now,
            has_begun: false,
            never_sleep: now,
            mode_set_again: None,
            write,
            imu: Imu::Unused,
        }
    }

    /// A notification of EMG arrived, which may be malformed.
    pub(super) const fn notified(&mut self, now: Millis) {
        if !self.has_begun {
            self.has_begun = true;
            self.emg(now);
        }
    }

    /// EMG arrived.
    pub(super) const fn emg(&mut self, now: Millis) {
        self.emg = now;
        self.mode_set_again = None;
    }

    /// The write was answered. A refused write does not end a running stream: if it mattered,
    /// silence follows.
    pub(super) const fn write_answered(&mut self) {
        self.write = None;
    }

    /// Whether the IMU is on in the armband's mode.
    pub(super) fn has_imu(&self) -> bool {
        IMU && self.imu == Imu::On
    }

    /// The write that is due at `now`, with the IMU or without; it counts as requested.
    pub(super) fn due(&mut self, now: Millis, imu: bool) -> Due {
        if self
            .write
            .is_some_and(|at| now.elapsed_since(at) >= OPERATION_MS)
        {
            return Due::Unanswered;
        }
        let patience = if self.has_begun { SILENCE_MS } else { START_MS };
        match self.mode_set_again {
            Some(at) if now.elapsed_since(at) >= patience => return Due::Stalled,
            None if now.elapsed_since(self.emg) >= patience => {
                // While another write is outstanding this one is skipped, not queued: a link that has
                // not answered for so long will not answer this one either.
                self.mode_set_again = Some(now);
                if self.write.is_none() {
                    self.write = Some(now);
                    return Due::SetMode;
                }
            }
            _ => {}
        }
        if self.write.is_none() && now.elapsed_since(self.never_sleep) >= NEVER_SLEEP_MS {
            self.never_sleep = now;
            self.write = Some(now);
            return Due::NeverSleep;
        }
        if IMU && self.write.is_none() {
            let (state, due) = match (self.imu, imu) {
                (Imu::Unused, true) => (Imu::Off, Due::SubscribeImu),
                (Imu::Off, true) => (Imu::On, Due::SetMode),
                (Imu::On, false) => (Imu::Off, Due::SetMode),
                _ => return Due::Nothing,
            };
            (self.imu, self.write) = (state, Some(now));
            return due;
        }
        Due::Nothing
    }
}
