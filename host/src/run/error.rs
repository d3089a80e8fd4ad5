//! Why a step of a run cannot be done.

use std::path::PathBuf;

use shared::model::file::ModelError;
use thiserror::Error;

use crate::evaluation::judge::JudgeError;
use crate::execution::run_folder::RunError;
use crate::teacher::checkpoint::CheckpointError;

/// Why a step of a run cannot be done.
#[derive(Debug, Error)]
pub enum StepError {
    /// The run folder, or the user interrupted.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Nobody chooses the checkpoint.
    #[error(
        "no subject is left to choose the checkpoint with: name one under data.validation, or give more recordings"
    )]
    NoValidation,
    /// Nobody is judged.
    #[error(
        "no labelled recording of a held-out subject is at hand: name subjects under data.held_out"
    )]
    NothingToJudge,
    /// Nothing is judged.
    #[error("no model in this run folder: train one first")]
    NoModel,
    /// Distillation without a teacher.
    #[error("{path}: no teacher to distil from; run `myointent train` first")]
    NoTeacher {
        /// File of the teacher's weights.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The checkpoint to start from.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A student that no device can run.
    #[error("this student cannot become a model file: {0}")]
    Student(#[source] ModelError),
    /// A model file that is refused.
    #[error("the model file is refused: {0}")]
    Model(#[from] ModelError),
    /// A metric or the smoother refuses.
    #[error(transparent)]
    Judge(#[from] JudgeError),
}

impl StepError {
    /// Whether the user interrupted.
    #[must_use]
    pub const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Run(RunError::Interrupted { .. }))
    }
}
