//! Tune step of a program built without training: it tells viewers so.

use super::Running;
use crate::cli::WITHOUT_TRAINING;
use crate::live::event::Event;
use crate::live::outcome::Tuning;

/// Message from the tuning thread; there is none.
#[derive(Debug)]
pub(super) enum Heard {}

impl Running {
    /// Tells viewers that the program was built without training.
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
