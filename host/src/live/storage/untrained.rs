//! Tune step of a program built without training: it tells viewers so.

use super::Keeper;
use crate::cli::WITHOUT_TRAINING;
use crate::live::stream::Input;
use web::event::Event;
use web::outcome::TuningState;
use web::said::Said;

impl Keeper {
    /// Tells viewers that the program was built without training.
    pub(super) fn tune(&mut self) {
        self.tuning = None;
        let without = TuningState::failed(Said::plain(WITHOUT_TRAINING));
        let _ = self
            .inputs
            .send(Input::Event(Event::Tuning(Box::new(without))));
    }
}
