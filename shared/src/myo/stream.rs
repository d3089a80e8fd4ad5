//! What keeps a stream alive, and notices when it is not.

use super::elapsed;
use crate::units::Millis;

/// Silence after which the mode is set again, and after that once more the connection given up.
const SILENCE_MS: u32 = 500;
/// How often the armband is told again never to sleep: harmless, and its own timer is 30 s.
const KEEP_AWAKE_MS: u32 = 10_000;
/// How long an operation may take.
pub(super) const ANSWER_MS: u32 = 5_000;

/// A stream under way.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Stream {
    /// When EMG last came.
    heard: Millis,
    /// When it was last told never to sleep.
    awake: Millis,
    /// When the mode was set again, for the silence that lasts.
    stirred: Option<Millis>,
    /// When the write that is not answered yet was asked for.
    written: Option<Millis>,
}

/// What is due.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Duty {
    Nothing,
    /// Tell it never to sleep.
    KeepAwake,
    /// Set its mode again.
    Stir,
    /// Give up: silent in spite of it all.
    Stalled,
    /// Give up: a write was never answered.
    Unanswered,
}

impl Stream {
    /// A stream that begins; `written` where the mode's confirmation is still to come.
    pub(super) const fn new(now: Millis, written: Option<Millis>) -> Self {
        Self {
            heard: now,
            awake: now,
            stirred: None,
            written,
        }
    }

    /// EMG came.
    pub(super) const fn hear(&mut self, now: Millis) {
        self.heard = now;
        self.stirred = None;
    }

    /// The write was answered. A refused one is no reason to end a stream that runs: if it
    /// matters, silence will tell.
    pub(super) const fn answered(&mut self) {
        self.written = None;
    }

    /// What is due at `now`; a write among it counts as asked for.
    pub(super) fn duty(&mut self, now: Millis) -> Duty {
        let since = |instant| elapsed(now, instant);
        if self.written.is_some_and(|at| since(at) >= ANSWER_MS) {
            return Duty::Unanswered;
        }
        match self.stirred {
            Some(at) if since(at) >= SILENCE_MS => return Duty::Stalled,
            None if since(self.heard) >= SILENCE_MS => {
                // Where another write is still unanswered this one is skipped, not queued: a link
                // that has not answered for so long will not answer this one either.
                self.stirred = Some(now);
                if self.written.is_none() {
                    self.written = Some(now);
                    return Duty::Stir;
                }
            }
            _ => {}
        }
        if self.written.is_none() && since(self.awake) >= KEEP_AWAKE_MS {
            self.awake = now;
            self.written = Some(now);
            return Duty::KeepAwake;
        }
        Duty::Nothing
    }
}
