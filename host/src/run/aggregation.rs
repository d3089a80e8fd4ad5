//! The smoother's aggregation mode: chosen on validation subjects, once per run.

use super::candidates::{student_candidate, teacher_candidate};
use super::context::RunContext;
use super::error::StepError;
use super::trials;
use crate::evaluation::{LookAhead, Truth, score};
use crate::student::distillation;
use crate::teacher;

/// Name of the file that keeps the chosen mode in a run folder.
pub(super) const AGGREGATION: &str = "aggregation.json";

/// The mode with which the student (or the teacher, in a run without a student) follows more transitions of the
/// validation subjects; all rows on a tie.
///
/// # Errors
/// When a model is damaged, labels cannot be compared or the folder cannot be written.
pub(super) fn aggregation(context: &RunContext) -> Result<LookAhead, StepError> {
    const NAME: &str = "choosing the aggregation mode";
    if context.folder.file(AGGREGATION).exists() {
        return Ok(context.folder.load_json(AGGREGATION)?);
    }
    let trials = trials::validation(&context.config, &context.library);
    let candidate = if context.has(distillation::NAME) {
        let student = context.student(distillation::NAME)?;
        student_candidate(context, NAME, &student, &trials)?
    } else if context.has(teacher::training::NAME) {
        teacher_candidate(context, NAME, &trials)?
    } else {
        return Ok(LookAhead::AllRows);
    };
    let correct = |look_ahead| -> Result<usize, StepError> {
        let scores = score(
            &candidate,
            &trials,
            context.config.preset.vocabulary(),
            look_ahead,
            Truth::LagCompensated,
        )?;
        // The last row is over all data sets.
        Ok(scores.last().map_or(0, |score| score.widest().correct))
    };
    let chosen = if correct(LookAhead::SameInstant)? > correct(LookAhead::AllRows)? {
        LookAhead::SameInstant
    } else {
        LookAhead::AllRows
    };
    context.folder.save_json(AGGREGATION, &chosen)?;
    Ok(chosen)
}
