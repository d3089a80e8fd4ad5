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
    /// Flash is written.
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
    /// Absence that begins, or was reported, at this time.
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
