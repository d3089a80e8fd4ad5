//! Tune step of a program built without training: it tells viewers so.

use super::RunningRecorder;
use crate::cli::WITHOUT_TRAINING;
use web::event::Event;
use web::outcome::TuningState;

/// Message from the tuning thread; this build has no such thread.
#[derive(Debug)]
pub(super) enum TuningProgress {}

impl RunningRecorder {
    /// Tells viewers that the program was built without training.
    pub(super) fn tune(&mut self) {
        self.tuned = None;
        self.recorder.hub.publish(&Event::Tuning(TuningState {
            state: "failed",
            text: WITHOUT_TRAINING.to_owned(),
            ..TuningState::default()
        }));
    }

    /// Does nothing: no tuning runs.
    pub(super) const fn publish_tuning(&self) {}
}
