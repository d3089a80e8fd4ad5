//! Errors of training a baseline.

use execution::run_folder::RunError;
use thiserror::Error;

use crate::baselines::lda::LdaError;

/// Why a baseline cannot be trained.
#[derive(Debug, Error)]
pub(crate) enum TrainingError {
    /// There is no labelled window to train or to validate with.
    #[error(
        "{baseline} has {training} training windows and {validation} validation windows; it needs both: give more labelled recordings"
    )]
    NoWindows {
        /// Name of the baseline.
        baseline: &'static str,
        /// Number of training windows.
        training: usize,
        /// Number of validation windows.
        validation: usize,
    },
    /// The discriminants cannot be fitted.
    #[error(transparent)]
    Lda(#[from] LdaError),
    /// The run folder cannot be used, or the user interrupted.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl TrainingError {
    /// Whether the user interrupted.
    pub(crate) const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Run(RunError::Interrupted { .. }))
    }
}
