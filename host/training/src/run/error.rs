//! Errors of a step of a run.

use std::path::PathBuf;

use presets::resolve::ConfigError;
use shared::model::file::ModelError;
use thiserror::Error;

use crate::teacher::checkpoint::CheckpointError;
use evaluation::EvaluationError;
use execution::run_folder::RunError;

/// Why a step of a run cannot be done.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum StepError {
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(
        "no subject is left to choose the checkpoint with: name one under data.validation, or give more recordings"
    )]
    NoValidation,
    #[error(
        "no labelled recording of a held-out subject was found: name subjects under data.held_out"
    )]
    NoRecordings,
    #[error("no model in this run folder: train one first")]
    NoModel,
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[error("{start} was changed since this run began: leave out --resume to begin anew from it")]
    StartChanged { start: PathBuf },
    #[error(
        "no board can run this student: {0}; make it smaller, or set `student.board = false` in the preset for a model that only a PC runs"
    )]
    Board(#[source] ModelError),
    #[error("{path}: no model file; run `myointent quantize` first")]
    NoModelFile {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{path} is not the model file of this run's student; run `myointent quantize` again")]
    OtherModelFile { path: PathBuf },
    #[error("this student cannot become a model file")]
    Student(#[source] ModelError),
    #[error("the model file is refused")]
    Model(#[from] ModelError),
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}

impl StepError {
    /// Whether the user interrupted.
    pub const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Run(error) if error.is_interrupt())
    }
}
