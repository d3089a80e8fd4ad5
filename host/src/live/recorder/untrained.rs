//! The tune step of a program that was built without training: it says what is missing.

use super::Running;
use crate::cli::WITHOUT_TRAINING;
use crate::live::event::Event;
use crate::live::outcome::Tuning;

/// Messages of a tuning: none.
#[derive(Debug)]
pub(super) enum Heard {}

impl Running {
    /// Tells viewers what is missing.
    pub(super) fn tune(&mut self) {
        self.tuned = None;
        self.recorder.hub.publish(&Event::Tuning(Tuning {
            state: "failed",
            text: WITHOUT_TRAINING.to_owned(),
            ..Tuning::default()
        }));
    }

    /// Does nothing: no tuning runs.
    pub(super) const fn tell_tuning(&self) {}
}
