//! Why a step of a run cannot be done.

use std::path::PathBuf;

use shared::model::file::ModelError;
use shared::stream::smoother::SettingsError;
use thiserror::Error;

use crate::evaluation::EvaluationError;
use crate::teacher::checkpoint::CheckpointError;
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
    NoTrials,
    /// Model files of different classes side by side.
    #[error("{first} and {other} have different classes: evaluate them one at a time")]
    DifferentClasses {
        /// A model.
        first: String,
        /// One of other classes.
        other: String,
    },
    /// Nobody is left to evaluate on.
    #[error(
        "no labelled recording is left: {seen} people were seen by the model in training (--seen evaluates them too), {test} are test people (--test-people)"
    )]
    NobodyToEvaluate {
        /// People left out because a model has seen them.
        seen: usize,
        /// Test people left out.
        test: usize,
    },
    /// A model that has seen somebody whom it is evaluated on.
    #[error(
        "{model} was trained on or validated with {subject}, whom this run holds out: evaluate another model, or a run that does not"
    )]
    Seen {
        /// The model.
        model: String,
        /// Somebody whom it has seen.
        subject: String,
    },
    /// Nobody can be aligned.
    #[error(
        "none of {people} people opens the hand twice in these recordings: leave out --align, or give others"
    )]
    NobodyOpens {
        /// People who could be evaluated otherwise.
        people: usize,
    },
    /// Too few people for an alignment template.
    #[error(
        "{found} of the people whom the model has seen open the hand in these recordings, {expected} are needed: give the recordings that it was trained on"
    )]
    NoTemplate {
        /// Fewest people.
        expected: usize,
        /// People found.
        found: usize,
    },
    /// An unknown name.
    #[error(transparent)]
    Name(#[from] SplitError),
    /// There is no model to evaluate.
    #[error("no model in this run folder: train one first")]
    NoModel,
    /// There is no teacher to distil from.
    #[error("{path}: no teacher to distil from; run `myointent train` first")]
    NoTeacher {
        /// File of the teacher's weights.
        path: PathBuf,
    },
    /// The checkpoint to start from cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The weights to start from are not those that the run began with.
    #[error("{start} was changed since this run began: leave out --resume to begin anew from it")]
    StartChanged {
        /// What training starts from.
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
    /// The model file in the run folder is not that of its student.
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
    /// The settings in the model file are for no board.
    #[error("the smoother's settings in the model file are refused")]
    Smoother(#[from] SettingsError),
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
