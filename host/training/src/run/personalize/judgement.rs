//! Scores of the old and the new model on what is held back.

use std::collections::HashMap;

use shared::intent::Vocabulary;
use shared::model::file::Model;

use super::error::PersonalizeError;
use super::part::PersonPart;
use super::rule::rate;
use crate::run::StepError;
use evaluation::integer_candidate;
use evaluation::model_evaluation::look_ahead;
use evaluation::{Candidate, EvaluatedRecording, LookAhead, Score, constant, score};
use recordings::movement::{Movement, MovementKind};

/// Step between margins over other movement that are tried, and their number.
const MARGIN_STEP: f32 = 0.25;
const MARGINS: u8 = 40;

/// Models on the parts of a person's recordings that each has not seen: integer arithmetic, the model's own look-ahead,
/// lag-compensated labels.
#[derive(Clone)]
pub(super) struct Judgement {
    candidate: Candidate,
    recordings: Vec<EvaluatedRecording>,
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
}

impl Judgement {
    /// Runs a model file, `name` in tables, on a part.
    pub(super) fn new(
        name: &str,
        file: &[u8],
        part: &PersonPart<'_>,
    ) -> Result<Self, PersonalizeError> {
        let model = Model::parse(file)?;
        let recordings = part.evaluated_recordings();
        Ok(Self {
            candidate: integer_candidate(name, &model, &recordings)?,
            recordings,
            vocabulary: model.header.dimensions.vocabulary,
            look_ahead: look_ahead(&model.header.smoother),
        })
    }

    /// Adds another part with another model of the same dimensions and settings.
    pub(super) fn and(mut self, other: Self) -> Self {
        self.candidate.logits.extend(other.candidate.logits);
        self.recordings.extend(other.recordings);
        self
    }

    /// Scores the models.
    pub(super) fn score(&self) -> Result<Score, PersonalizeError> {
        self.only(&self.candidate, self.look_ahead)
    }

    /// Scores always relax on the same parts.
    pub(super) fn constant(&self) -> Result<Score, PersonalizeError> {
        self.only(&constant(&self.recordings), LookAhead::None)
    }

    fn only(
        &self,
        candidate: &Candidate,
        look_ahead: LookAhead,
    ) -> Result<Score, PersonalizeError> {
        let mut scores = score(candidate, &self.recordings, self.vocabulary, look_ahead)?;
        // One row: all recordings of a person are of one data set.
        scores.pop().ok_or(StepError::NoRecordings.into())
    }

    /// Halves the other movement: one judgement to choose a margin on, and one to judge it on. Every second movement of a
    /// kind goes to either; one that is alone of its kind is cut in its middle.
    pub(super) fn halves(self) -> (Self, Self) {
        let (mut choosing, mut judging) = (self.clone(), self);
        let all = judging
            .recordings
            .iter()
            .flat_map(|own| &own.other_movement);
        let mut movements: HashMap<MovementKind, usize> = HashMap::new();
        all.for_each(|own| *movements.entry(own.kind).or_default() += 1);
        let mut taken: HashMap<MovementKind, usize> = HashMap::new();
        for (choice, judged) in choosing.recordings.iter_mut().zip(&mut judging.recordings) {
            let (choice, judged) = (&mut choice.other_movement, &mut judged.other_movement);
            choice.clear();
            for Movement { kind, samples } in std::mem::take(judged) {
                let taken = taken.entry(kind).or_default();
                *taken += 1;
                if movements[&kind] == 1 {
                    let middle = usize::midpoint(samples.start, samples.end);
                    choice.push(Movement::new(kind, samples.start..middle));
                    judged.push(Movement::new(kind, middle..samples.end));
                } else if *taken % 2 == 1 {
                    choice.push(Movement::new(kind, samples));
                } else {
                    judged.push(Movement::new(kind, samples));
                }
            }
        }
        (choosing, judging)
    }

    /// Judges with another margin over other movement.
    pub(super) fn set_margin(&mut self, margin: f32) {
        self.candidate.margins.other = Some(margin);
    }

    /// Raises the margin over other movement, by at most 10, until it raises at most `wanted` labels a minute, and returns it.
    pub(super) fn raise_margin(&mut self, wanted: f64) -> Result<f32, PersonalizeError> {
        let own = self.candidate.margins.other;
        let own = own.ok_or(PersonalizeError::NoOtherClass)?;
        let mut found = 0.0;
        for step in 0..=MARGINS {
            let margin = own + f32::from(step) * MARGIN_STEP;
            self.candidate.margins.other = Some(margin);
            let rate = rate(&self.score()?, |own| own.other_movement);
            found = rate.per_minute().ok_or(PersonalizeError::NoOthers)?;
            if found <= wanted {
                return Ok(margin);
            }
        }
        Err(PersonalizeError::OtherPerMinute { wanted, found })
    }
}

/// Scores a model file, `name` in tables, on a part of a person's recordings.
pub fn judge(name: &str, file: &[u8], part: &PersonPart<'_>) -> Result<Score, PersonalizeError> {
    Judgement::new(name, file, part)?.score()
}
