//! Errors of tuning a model on a person's recordings.

use serde::Serialize;
use shared::model::file::ModelError;
use thiserror::Error;

use crate::run::StepError;
use evaluation::EvaluationError;
use execution::run_folder::RunError;

/// Why a model cannot be tuned on a person's recordings.
#[derive(Debug, Serialize, Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum PersonalizeError {
    #[error("the recordings are of {}: name the person with --subject", .found.join(", "))]
    SeveralPeople { found: Vec<String> },
    #[error("no recording of {wanted}; there are recordings of {}", .found.join(", "))]
    #[serde(skip)]
    UnknownPerson { wanted: String, found: Vec<String> },
    #[error(
        "no recording of {subject} has a label: record with cues, or give a folder in a layout with labels (docs/recordings.md)"
    )]
    NoLabels { subject: String },
    #[error(
        "the model tells {} apart, the recordings have {} alone: give a model of these gestures",
        .expected.join(", "),
        .recorded.join(", ")
    )]
    Vocabulary {
        expected: Vec<&'static str>,
        recorded: Vec<&'static str>,
    },
    #[error(
        "no recording has {missing}, which the model would unlearn: record each of {} several times",
        .expected.join(", ")
    )]
    MissingClass {
        missing: &'static str,
        expected: Vec<&'static str>,
    },
    #[error(
        "too short: the part of the recordings that is {part} has {class} {found} times, {expected} are needed; some of it is tuned on and the rest held back, so record each gesture {each} times or more"
    )]
    TooShort {
        part: &'static str,
        class: &'static str,
        expected: usize,
        found: usize,
        each: usize,
    },
    #[error(
        "the recordings have neither a change of the label nor two steady holds: record rest and gestures in turn"
    )]
    NoChange,
    #[error(
        "the model has no class for other movement, so no margin over it: give a model with one, or leave --other-per-minute out"
    )]
    #[serde(skip)]
    NoOtherClass,
    #[error(
        "no other movement is held back, so its margin cannot be chosen: record other movement, or leave --other-per-minute out"
    )]
    #[serde(skip)]
    NoOthers,
    #[error(
        "other movement raises {found:.1} labels a minute of what is held back at the highest margin, at most {wanted} are wanted. Nothing was written, go on with the old model"
    )]
    #[serde(skip)]
    OtherPerMinute { wanted: f64, found: f64 },
    #[error("{0}. Nothing was written, go on with the old model")]
    Exchanged(Exchange),
    #[error("interrupted; nothing was written")]
    #[serde(skip)]
    Interrupted,
    #[error("the model file is refused")]
    Model(
        #[from]
        #[serde(skip)]
        ModelError,
    ),
    #[error("the tuned weights make no model file; nothing was written")]
    Tuned(
        #[source]
        #[serde(skip)]
        ModelError,
    ),
    #[error(transparent)]
    #[serde(skip)]
    Training(RunError),
    #[error(transparent)]
    #[serde(skip)]
    Judgement(#[from] StepError),
}

impl From<EvaluationError> for PersonalizeError {
    fn from(error: EvaluationError) -> Self {
        Self::Judgement(error.into())
    }
}

impl PersonalizeError {
    /// Whether the user interrupted.
    pub const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Interrupted)
    }

    /// Whether the old model is to be kept.
    pub const fn keeps_the_old(&self) -> bool {
        matches!(self, Self::Exchanged(_) | Self::OtherPerMinute { .. })
    }
}

/// Doubt about the recordings of a person.
#[derive(Clone, PartialEq, Debug, Serialize, Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Doubt {
    #[error("{0}")]
    Exchanged(Exchange),
    #[error(
        "the model before is hardly better than always saying relax on these recordings: look at them with `myointent data inspect`, above all at their scale, at hum and at the labels"
    )]
    ConstantBefore,
}

/// Two classes whose labels seem exchanged.
#[derive(Clone, PartialEq, Debug, Serialize, Error)]
#[error(
    "{} and {} seem exchanged{}: with the two exchanged the model before has {exchanged:.2} balanced accuracy instead of {before:.2}. Exchange the two in the labels. If the labels are right, the armband sits turned half way round: turn it, or align it (docs/alignment.md), and record again",
    .classes[0], .classes[1], within(.recordings)
)]
pub struct Exchange {
    /// Names of the two classes.
    pub classes: [&'static str; 2],
    /// Whether each of the two is mostly taken for the other; otherwise only one of them is.
    pub is_mutual: bool,
    /// Names of the recordings with the exchange; empty if it was found over all of them together.
    pub recordings: Vec<String>,
    /// Balanced accuracy of the model on these recordings, as labelled.
    pub before: f64,
    /// Balanced accuracy of the model with the two classes exchanged.
    pub exchanged: f64,
}

fn within(recordings: &[String]) -> String {
    if recordings.is_empty() {
        return String::new();
    }
    format!(" in {}", recordings.join(", "))
}
