//! Requests to a simulated person.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use recordings::labels::motion::Motion;
use shared::units::SampleIndex;

/// Greatest number of samples that the person may be ahead of the reader: 0.1 s of its stream.
const AHEAD: u32 = 20;

/// Gesture that is asked for, and the reader's position in the person's samples; shared by all clones.
///
/// The person waits for the reader, so that it follows a cue at the same sample, however busy the machine is.
#[derive(Clone, Debug)]
pub struct SharedCue(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    has_read: Condvar,
}

#[derive(Debug)]
struct State {
    motion: Motion,
    /// First sample that was not read yet.
    unread: SampleIndex,
}

impl Default for SharedCue {
    fn default() -> Self {
        let state = State {
            motion: Motion::RELAX,
            unread: SampleIndex(0),
        };
        Self(Arc::new(Shared {
            state: Mutex::new(state),
            has_read: Condvar::new(),
        }))
    }
}

impl SharedCue {
    /// Asks for a gesture.
    pub fn set(&self, motion: Motion) {
        self.state().motion = motion;
    }

    /// Records that all samples before `unread` were read.
    pub fn read(&self, unread: SampleIndex) {
        self.state().unread = unread;
        self.0.has_read.notify_one();
    }

    /// Gesture asked for at a sample. Waits while the sample is too far ahead of the reader, at most for `patience`.
    pub fn at(&self, sample: SampleIndex, patience: Duration) -> Motion {
        let is_ahead = |state: &mut State| sample.since(state.unread) > AHEAD;
        let mut state = self.state();
        // A browser's worker has no clock to wait with, and reads each sample at once.
        if !is_ahead(&mut state) {
            return state.motion;
        }
        let waited = self
            .0
            .has_read
            .wait_timeout_while(state, patience, is_ahead);
        waited.unwrap_or_else(PoisonError::into_inner).0.motion
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;

    const OPEN: Motion = Motion::Intent(Intent::Open);

    /// Duration longer than any test.
    const FOREVER: Duration = Duration::from_secs(3600);

    #[test]
    fn a_person_waits_for_a_reader_who_is_far_behind() {
        let cue = SharedCue::default();
        let person = cue.clone();
        let follows = std::thread::spawn(move || person.at(SampleIndex(AHEAD + 1), FOREVER));
        // It must not answer before, however long this thread waits: relax would be the answer.
        std::thread::sleep(Duration::from_millis(20));
        cue.set(OPEN);
        cue.read(SampleIndex(1));
        assert_eq!(follows.join().unwrap(), OPEN);
    }

    #[test]
    fn a_person_does_not_wait_for_a_reader_who_is_near_or_reads_no_more() {
        let cue = SharedCue::default();
        cue.set(OPEN);
        assert_eq!(cue.at(SampleIndex(AHEAD), FOREVER), OPEN);
        let soon = Duration::from_millis(1);
        assert_eq!(cue.at(SampleIndex(1000), soon), OPEN);
        // The index wraps.
        cue.read(SampleIndex(u32::MAX));
        assert_eq!(cue.at(SampleIndex(3), FOREVER), OPEN);
    }
}
