//! Why models cannot be evaluated.

use execution::run_folder::RunError;
use recordings::split::SplitError;
use shared::model::file::ModelError;
use shared::stream::smoother::SettingsError;
use thiserror::Error;

use crate::metric::MetricError;

/// Why a model cannot be evaluated.
#[derive(Debug, Error)]
pub enum EvaluationError {
    /// The label sequences cannot be compared.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// The smoother's settings are invalid.
    #[error(transparent)]
    Smoother(#[from] SettingsError),
    /// Too few people for an alignment template.
    #[error(
        "{found} of the people whom the model has seen open the hand in these recordings, {expected} are needed: give the recordings that it was trained on"
    )]
    NoTemplate {
        /// Minimum number of people.
        expected: usize,
        /// People found.
        found: usize,
    },
    /// There is no model to evaluate.
    #[error("no model to evaluate: give a model file")]
    NoModel,
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
        "none of {people} people opens the hand twice in these recordings: leave out --align, or give others"
    )]
    NobodyOpens {
        /// People who could be evaluated otherwise.
        people: usize,
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
