//! Reason why a board has no model, and its repeated report.

use crate::model::file::ModelError;
use crate::stream::smoother::SettingsError;
use crate::units::Millis;

/// Milliseconds between two reports that there is no model: long enough to read and short enough for a terminal that is
/// connected late.
const REPEAT_MS: u32 = 1000;

/// Reason why a board has no model.
#[derive(Clone, Copy, Debug, thiserror::Error)]
pub enum ModelRefused {
    /// The file is refused.
    #[error("model refused: {0}")]
    Model(#[from] ModelError),
    /// The smoother refuses the settings of the model.
    #[error("model refused: {0}")]
    Smoother(#[from] SettingsError),
    /// An installation is in progress, or was interrupted.
    #[error(
        "no model: an installation is not complete; `myointent board --port PATH install FILE` with the same file goes on with it"
    )]
    Incomplete,
    /// The calibration is being written.
    #[error("no model while the calibration is written")]
    Keeping,
}

/// Repeated report that there is no model.
#[derive(Clone, Copy, Debug)]
pub struct Absence {
    reason: ModelRefused,
    reported: Millis,
}

impl Absence {
    /// Absence from this time on; it is reported again after a second.
    #[must_use]
    pub const fn began(reported: Millis, reason: ModelRefused) -> Self {
        Self { reason, reported }
    }

    /// Reason that is to be reported again; `None` until that is due.
    pub fn due(&mut self, now: Millis) -> Option<ModelRefused> {
        let is_due = now.elapsed_since(self.reported) >= REPEAT_MS;
        is_due.then(|| {
            self.reported = now;
            self.reason
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_reported_again_each_second_across_the_wrap_of_the_clock() {
        let began = Millis(u32::MAX - 499);
        let mut absence = Absence::began(began, ModelRefused::Keeping);
        for (later, is_due) in [(999, false), (1000, true), (1001, false), (2000, true)] {
            let now = Millis(began.0.wrapping_add(later));
            assert_eq!(absence.due(now).is_some(), is_due, "{later}");
        }
    }
}
