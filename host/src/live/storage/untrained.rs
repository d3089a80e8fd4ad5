//! Tune step of a program built without training: it tells viewers so.

use super::Keeper;
use crate::cli::WITHOUT_TRAINING;
use crate::live::stream::Input;
use web::event::Event;
use web::outcome::TuningState;

impl Keeper {
    /// Tells viewers that the program was built without training.
    pub(super) fn tune(&mut self) {
        self.tuning = None;
        let _ = self.inputs.send(Input::Event(Event::Tuning(TuningState {
            state: "failed",
            text: WITHOUT_TRAINING.to_owned(),
            ..TuningState::default()
        })));
    }
}
