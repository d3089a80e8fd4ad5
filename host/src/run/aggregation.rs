//! Which aggregation mode the smoother runs with: chosen on validation subjects, once a run.

use super::candidates::{student_candidate, teacher_candidate};
use super::context::RunContext;
use super::error::StepError;
use super::quantize::AGGREGATION;
use super::trials;
use crate::evaluation::judge::{LookAhead, Truth, judge};
use crate::student::distillation;
use crate::teacher;

/// The mode with which the student, or a teacher without one, follows more transitions of the
/// validation subjects; all rows on a tie.
///
/// # Errors
/// When a model is damaged, a metric refuses or the folder cannot be written.
pub fn aggregation(context: &RunContext) -> Result<LookAhead, StepError> {
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
    let followed = |look_ahead| -> Result<usize, StepError> {
        let rows = judge(
            &candidate,
            &trials,
            context.config.preset.vocabulary(),
            look_ahead,
            Truth::LagCompensated,
        )?;
        Ok(rows.last().map_or(0, |row| row.widest().correct))
    };
    let chosen = if followed(LookAhead::SameInstant)? > followed(LookAhead::AllRows)? {
        LookAhead::SameInstant
    } else {
        LookAhead::AllRows
    };
    context.folder.save_json(AGGREGATION, &chosen)?;
    Ok(chosen)
}
