//! Scores of the old and the new model on what is held back.

use shared::intent::Vocabulary;
use shared::model::file::Model;

use super::error::PersonalizeError;
use super::part::Part;
use super::rule::rate;
use crate::run::StepError;
use evaluation::integer_candidate;
use evaluation::model_evaluation::look_ahead;
use evaluation::{Candidate, EvaluatedRecording, LookAhead, Score, Truth, constant, score};

/// Step between margins over other movement that are tried, and their number.
const MARGIN_STEP: f32 = 0.25;
const MARGINS: u8 = 40;

/// Models on the parts of a person's recordings that each has not seen: integer arithmetic, the model's own look-ahead,
/// lag-compensated labels.
pub(super) struct Judgement {
    candidate: Candidate,
    recordings: Vec<EvaluatedRecording>,
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
}

impl Judgement {
    /// Runs a model file, `name` in tables, on a part.
    ///
    /// # Errors
    /// When the model is refused.
    pub(super) fn new(name: &str, file: &[u8], part: &Part<'_>) -> Result<Self, PersonalizeError> {
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
        only(
            &self.candidate,
            &self.recordings,
            self.vocabulary,
            self.look_ahead,
        )
    }

    /// Scores always relax on the same parts.
    pub(super) fn constant(&self) -> Result<Score, PersonalizeError> {
        let constant = constant(&self.recordings);
        only(
            &constant,
            &self.recordings,
            self.vocabulary,
            LookAhead::None,
        )
    }

    /// Raises the margin over other movement until it raises at most `wanted` labels a minute, and returns it.
    ///
    /// # Errors
    /// When the model has no margin, no other movement is held back, or no margin up to 10 more than the model's suffices.
    pub(super) fn raise_margin(&mut self, wanted: f64) -> Result<f32, PersonalizeError> {
        let own = self.candidate.other_margin;
        let own = own.ok_or(PersonalizeError::NoOtherClass)?;
        let mut found = 0.0;
        for step in 0..=MARGINS {
            let margin = own + f32::from(step) * MARGIN_STEP;
            self.candidate.other_margin = Some(margin);
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
///
/// # Errors
/// When the model is refused.
pub fn judge(name: &str, file: &[u8], part: &Part<'_>) -> Result<Score, PersonalizeError> {
    Judgement::new(name, file, part)?.score()
}

/// Scores a constant label, relax.
///
/// # Errors
/// As [`judge`].
pub fn judge_constant(part: &Part<'_>, vocabulary: Vocabulary) -> Result<Score, PersonalizeError> {
    let recordings = part.evaluated_recordings();
    only(
        &constant(&recordings),
        &recordings,
        vocabulary,
        LookAhead::None,
    )
}

fn only(
    candidate: &Candidate,
    recordings: &[EvaluatedRecording],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Score, PersonalizeError> {
    let truth = Truth::LagCompensated;
    let mut scores = score(candidate, recordings, vocabulary, look_ahead, truth)?;
    // One row: all recordings of a person are of one data set.
    scores.pop().ok_or(StepError::NoRecordings.into())
}
