//! Errors of the crate.

use crate::calibration::FEWEST_ROUNDS;
use crate::model_evaluation::SET_ASIDE;
use execution::run_folder::RunError;
use recordings::split::SplitError;
use shared::model::file::ModelError;
use shared::stream::smoother::SettingsError;
use thiserror::Error;

/// Reason why labels cannot be compared, a model cannot be evaluated or a report cannot be written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum EvaluationError {
    #[error("expected as many predicted labels as true ones ({truth}), found {prediction}")]
    Length { truth: usize, prediction: usize },
    #[error("expected a buffer of at least 2 samples, found {0}")]
    NarrowBuffer(usize),
    #[error(
        "expected true labels of at least two samples, found one of a single sample at {0}: \
         join it to its neighbours"
    )]
    SingleSampleLabel(usize),
    #[error(transparent)]
    Smoother(#[from] SettingsError),
    #[error("no model to evaluate: give a model file")]
    NoModel,
    #[error("two rows of the results would be named {0}: rename a model")]
    SameName(String),
    #[error("{first} and {other} have different classes: evaluate them one at a time")]
    DifferentClasses { first: String, other: String },
    #[error(
        "no labelled recording is left: {seen} people were seen by the model in training (--seen evaluates them too), {test} are test people (--test-people)"
    )]
    NobodyToEvaluate { seen: usize, test: usize },
    #[error(
        "expected a file of labels for each recording, such as {first}.csv, found none for any of {recordings} labelled recordings"
    )]
    NoLabels { recordings: usize, first: String },
    #[error(
        "{model} was trained on or validated with {subject}, whom this run holds out: evaluate another model, or a run that does not"
    )]
    Seen { model: String, subject: String },
    #[error(
        "none of {0} people opens the hand twice in these recordings: leave out --align, or give others"
    )]
    NobodyOpens(usize),
    #[error(
        "none of {0} people holds each gesture {SET_ASIDE} times for half a second: leave out --calibrate, or give others"
    )]
    NobodyHolds(usize),
    #[error("the recordings are of {}: name the person with --subject", _0.join(", "))]
    Whose(Vec<String>),
    #[error(
        "found {0} labelled holds of each gesture of half a second or more, with rest between them; {FEWEST_ROUNDS} are needed: record more"
    )]
    FewRounds(usize),
    #[error("{subject}: {refusal}")]
    NotCalibrated { subject: String, refusal: String },
    /// A file of the report could not be written whole, or one of the run could not be read; nothing of an older report
    /// was touched.
    #[error(transparent)]
    Run(#[from] RunError),
    #[error(transparent)]
    Name(#[from] SplitError),
    #[error("the model file is refused")]
    Model(#[from] ModelError),
}
