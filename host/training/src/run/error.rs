//! Errors of a step of a run.

use std::path::PathBuf;

use presets::resolve::ConfigError;
use shared::model::file::ModelError;
use thiserror::Error;

use crate::teacher::checkpoint::CheckpointError;
use evaluation::EvaluationError;
use execution::run_folder::RunError;
use recordings::split::SplitError;

/// Why a step of a run cannot be done.
#[derive(Debug, Error)]
pub enum StepError {
    /// The run folder cannot be used, or the user interrupted.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There are no validation subjects.
    #[error(
        "no subject is left to choose the checkpoint with: name one under data.validation, or give more recordings"
    )]
    NoValidation,
    /// There is no recording to evaluate on.
    #[error(
        "no labelled recording of a held-out subject was found: name subjects under data.held_out"
    )]
    NoRecordings,
    /// The model has seen a person that it is evaluated on.
    #[error(
        "{model} was trained on or validated with {subject}, whom this run holds out: evaluate another model, or a run that does not"
    )]
    Seen {
        /// The model.
        model: String,
        /// Person that the model has seen.
        subject: String,
    },
    /// A name is unknown.
    #[error(transparent)]
    Name(#[from] SplitError),
    /// There is no model to evaluate.
    #[error("no model in this run folder: train one first")]
    NoModel,
    /// The configuration is invalid.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The checkpoint to start from cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The weights to start from have changed since the run began.
    #[error("{start} was changed since this run began: leave out --resume to begin anew from it")]
    StartChanged {
        /// Run folder or file that training starts from.
        start: PathBuf,
    },
    /// No board has room for the student.
    #[error(
        "no board can run this student: {0}; make it smaller, or set `student.board = false` in the preset for a model that only a PC runs"
    )]
    Board(#[source] ModelError),
    /// There is no model file.
    #[error("{path}: no model file; run `myointent quantize` first")]
    NoModelFile {
        /// The model file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The model file in the run folder is of another student.
    #[error("{path} is not the model file of this run's student; run `myointent quantize` again")]
    OtherModelFile {
        /// The model file.
        path: PathBuf,
    },
    /// The model format does not allow the student's dimensions.
    #[error("this student cannot become a model file")]
    Student(#[source] ModelError),
    /// The model file is invalid.
    #[error("the model file is refused")]
    Model(#[from] ModelError),
    /// The models cannot be evaluated.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}

impl StepError {
    /// Whether the user interrupted.
    #[must_use]
    pub const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Run(error) if error.is_interrupt())
    }
}
