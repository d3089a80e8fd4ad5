//! Errors of tuning a model on a person's recordings.

use shared::model::file::ModelError;
use thiserror::Error;

use crate::run::StepError;
use evaluation::EvaluationError;
use execution::run_folder::RunError;

/// Why a model cannot be tuned on a person's recordings.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum PersonalizeError {
    #[error("the recordings are of {}: name the person with --subject", .found.join(", "))]
    SeveralPeople { found: Vec<String> },
    #[error("no recording of {wanted}; there are recordings of {}", .found.join(", "))]
    UnknownPerson { wanted: String, found: Vec<String> },
    #[error(
        "no recording of {subject} has a label: record with cues, or give a folder in a layout with labels (docs/recordings.md)"
    )]
    NoLabels { subject: String },
    #[error(
        "the model tells {} apart, the recordings have {} alone: give a model of these gestures",
        .expected.join(", "),
        .found.join(", ")
    )]
    Vocabulary {
        expected: Vec<&'static str>,
        found: Vec<&'static str>,
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
        "too short: the part of the recordings that is {part} has {class} {found} times, {expected} are needed; some of it is tuned on and the rest held back, so record each gesture {} times or more",
        3 * .expected
    )]
    TooShort {
        part: &'static str,
        class: &'static str,
        expected: usize,
        found: usize,
    },
    #[error(
        "the recordings have neither a change of the label nor two steady holds: record rest and gestures in turn"
    )]
    NoChange,
    #[error(
        "the model has no class for other movement, so no margin over it: give a model with one, or leave --other-per-minute out"
    )]
    NoOtherClass,
    #[error(
        "no other movement is held back, so its margin cannot be chosen: record other movement, or leave --other-per-minute out"
    )]
    NoOthers,
    #[error(
        "other movement raises {found:.1} labels a minute of what is held back at the highest margin, at most {wanted} are wanted. Nothing was written, go on with the old model"
    )]
    OtherPerMinute { wanted: f64, found: f64 },
    #[error("{0}. Nothing was written, go on with the old model")]
    Exchanged(Exchange),
    #[error("interrupted; nothing was written")]
    Interrupted,
    #[error("the model file is refused")]
    Model(#[from] ModelError),
    #[error("the tuned weights make no model file; nothing was written")]
    Tuned(#[source] ModelError),
    #[error(transparent)]
    Training(RunError),
    #[error(transparent)]
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

/// Two classes whose labels seem exchanged.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
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
