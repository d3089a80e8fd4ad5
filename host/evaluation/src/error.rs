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
pub enum EvaluationError {
    /// Label sequences of different length.
    #[error("expected as many predicted labels as true ones ({truth}), found {prediction}")]
    Length {
        /// Labels of the truth.
        truth: usize,
        /// Labels of the prediction.
        prediction: usize,
    },
    /// A buffer around changes too narrow to contain a change.
    #[error("expected a buffer of at least 2 samples, found {0}")]
    NarrowBuffer(usize),
    /// A true label of a single sample: its change cannot have a buffer.
    #[error(
        "expected true labels of at least two samples, found one of a single sample at {0}: \
         join it to its neighbours"
    )]
    SingleSampleLabel(usize),
    /// The smoother's settings are invalid.
    #[error(transparent)]
    Smoother(#[from] SettingsError),
    /// There is no model to evaluate.
    #[error("no model to evaluate: give a model file")]
    NoModel,
    /// Two models of one name, or a model of a floor's.
    #[error("two rows of the results would be named {0}: rename a model")]
    SameName(String),
    /// Model files of different classes side by side.
    #[error("{first} and {other} have different classes: evaluate them one at a time")]
    DifferentClasses {
        /// A model.
        first: String,
        /// A model of other classes.
        other: String,
    },
    /// No person is left to evaluate on.
    #[error(
        "no labelled recording is left: {seen} people were seen by the model in training (--seen evaluates them too), {test} are test people (--test-people)"
    )]
    NobodyToEvaluate {
        /// People left out because a model has seen them.
        seen: usize,
        /// Test people left out.
        test: usize,
    },
    /// No recording has labels of the program.
    #[error(
        "expected a file of labels for each recording, such as {first}.csv, found none for any of {recordings} labelled recordings"
    )]
    NoLabels {
        /// Labelled recordings.
        recordings: usize,
        /// The first of them.
        first: String,
    },
    /// A model has seen a person whom it is evaluated on.
    #[error(
        "{model} was trained on or validated with {subject}, whom this run holds out: evaluate another model, or a run that does not"
    )]
    Seen {
        /// The model.
        model: String,
        /// A person whom it has seen.
        subject: String,
    },
    /// No person can be aligned.
    #[error(
        "none of {0} people opens the hand twice in these recordings: leave out --align, or give others"
    )]
    NobodyOpens(usize),
    /// No person can be calibrated.
    #[error(
        "none of {0} people holds each gesture {SET_ASIDE} times for half a second: leave out --calibrate, or give others"
    )]
    NobodyHolds(usize),
    /// Several people, or nobody of the name given.
    #[error("the recordings are of {}: say whose are meant with --subject", _0.join(", "))]
    Whose(Vec<String>),
    /// Too few holds to calibrate a model.
    #[error(
        "found {0} labelled holds of each gesture of half a second or more, with rest between them; {FEWEST_ROUNDS} are needed: record more"
    )]
    FewRounds(usize),
    /// A person's holds teach nothing.
    #[error("{subject}: {refusal}")]
    NotCalibrated {
        /// The person.
        subject: String,
        /// Reason.
        refusal: String,
    },
    /// A file of the report could not be written whole, or one of the run could not be read; nothing of an older report
    /// was touched.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An unknown name.
    #[error(transparent)]
    Name(#[from] SplitError),
    /// The model file is invalid.
    #[error("the model file is refused")]
    Model(#[from] ModelError),
}
