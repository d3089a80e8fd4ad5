//! A model under evaluation.

use crate::EvaluatedRecording;
use crate::EvaluationError;
use crate::inference::logits_with;
use rayon::prelude::*;
use shared::intent::Vocabulary;
use shared::model::LookBackLogits;
use shared::model::file::{Model, SmootherDefaults};
use shared::model::head::Head;
use shared::stream::alignment::Alignment;
use shared::stream::smoother::{Margins, Settings, SettingsError};

use super::condition::LookAhead;
use super::smoothing::{SmoothedLabels, smooth};
use super::system::System;

/// A model under evaluation: its logits over every recording.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name in tables.
    pub model: System,
    /// Whether the model gives logits of past patches too. Without them a label cannot be based on later windows, so
    /// there is no look-ahead.
    pub looks_back: bool,
    /// Logits at each patch of each recording, in the order of the recordings.
    pub logits: Vec<Vec<LookBackLogits>>,
    /// Margins of the model's labels.
    pub margins: Margins,
}

impl Candidate {
    /// A model with logits of past patches and the margins of its file.
    pub fn new(
        model: impl Into<System>,
        logits: Vec<Vec<LookBackLogits>>,
        smoother: &SmootherDefaults,
    ) -> Self {
        Self {
            margins: smoother.margins,
            ..Self::without_margins(model, true, logits)
        }
    }

    /// A model without confidence gate, whose labels wait for their look-ahead.
    pub fn without_margins(
        model: impl Into<System>,
        looks_back: bool,
        logits: Vec<Vec<LookBackLogits>>,
    ) -> Self {
        Self {
            model: model.into(),
            looks_back,
            logits,
            margins: Margins::NONE,
        }
    }

    /// Look-ahead conditions that the model can be evaluated under.
    pub(crate) fn conditions(&self) -> impl Iterator<Item = LookAhead> {
        LookAhead::ALL
            .into_iter()
            .filter(|&look_ahead| self.looks_back || look_ahead == LookAhead::None)
    }

    fn settings(&self, look_ahead: LookAhead) -> Settings {
        Settings {
            margins: self.margins,
            ..look_ahead.settings()
        }
    }

    /// Labels of a recording under a condition; `at` is its place among the recordings.
    pub(crate) fn labels(
        &self,
        at: usize,
        recording: &EvaluatedRecording,
        vocabulary: Vocabulary,
        look_ahead: LookAhead,
    ) -> Result<SmoothedLabels, SettingsError> {
        let (logits, classes) = (&self.logits[at], vocabulary.classes());
        let settings = self.settings(look_ahead);
        smooth(logits, recording.emg.len(), classes, settings)
    }

    /// The condition `wanted`, or no look-ahead for a model that supports no other.
    pub(crate) fn condition(&self, wanted: LookAhead) -> LookAhead {
        if self.looks_back {
            wanted
        } else {
            LookAhead::None
        }
    }
}

/// The logits of a model file's integer student over all recordings.
pub fn integer_candidate(
    name: impl Into<System>,
    model: &Model<'_>,
    recordings: &[EvaluatedRecording],
) -> Result<Candidate, EvaluationError> {
    let as_it_is = |_: &EvaluatedRecording| (Alignment::NONE, None);
    candidate(name, model, recordings, as_it_is)
}

/// A model file's candidate, with the alignment and the head that `own` gives for a recording; none for the model's own head.
pub(crate) fn candidate<'h>(
    system: impl Into<System>,
    model: &Model<'_>,
    recordings: &[EvaluatedRecording],
    own: impl Fn(&EvaluatedRecording) -> (Alignment, Option<&'h Head>) + Sync,
) -> Result<Candidate, EvaluationError> {
    let of = |recording: &EvaluatedRecording| {
        let (alignment, head) = own(recording);
        logits_with(
            model,
            head,
            &recording.input(model.header.preprocessing, alignment),
        )
    };
    let logits = recordings.par_iter().map(of).collect::<Result<_, _>>()?;
    Ok(Candidate::new(system, logits, &model.header.smoother))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_without_past_patches_is_evaluated_without_look_ahead_alone() {
        let conditions = |looks_back| {
            let candidate = Candidate::without_margins("any", looks_back, Vec::new());
            candidate.conditions().collect::<Vec<_>>()
        };
        assert_eq!(conditions(false), [LookAhead::None]);
        assert_eq!(conditions(true), LookAhead::ALL);
    }
}
