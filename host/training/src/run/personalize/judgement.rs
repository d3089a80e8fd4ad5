//! Scores of the old and the new model on the part held back.

use shared::intent::Vocabulary;
use shared::model::file::Model;

use super::error::PersonalizeError;
use super::part::Part;
use crate::run::StepError;
use evaluation::integer_candidate;
use evaluation::model_evaluation::look_ahead;
use evaluation::{Candidate, EvaluatedRecording, LookAhead, Score, Truth, constant, score};

/// Scores a model file, `name` in tables, on a part of a person's recordings: integer arithmetic, the model's own look-ahead,
/// lag-compensated labels.
///
/// # Errors
/// When the model is refused.
pub fn judge(name: &str, file: &[u8], part: &Part<'_>) -> Result<Score, PersonalizeError> {
    let model = Model::parse(file)?;
    let recordings = part.evaluated_recordings();
    let candidate = integer_candidate(name, &model, &recordings)?;
    let look_ahead = look_ahead(&model.header.smoother);
    let vocabulary = model.header.dimensions.vocabulary;
    only(&candidate, &recordings, vocabulary, look_ahead)
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
