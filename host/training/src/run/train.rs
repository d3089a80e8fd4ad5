//! Training of a run's models: what the preset asks for, and what is asked beyond it.

use presets::distillation;

use super::context::RunContext;
use super::error::StepError;
use super::student::train_student;
pub use super::teacher::train_teacher;

/// Models to train beyond those that the preset's student needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extra {
    /// The teacher, even if the student does not learn from it.
    pub teacher: bool,
    /// A second student, on the labels alone, to measure the effect of distillation.
    pub labels_only: bool,
}

/// Trains the models of a run: the teacher if the student learns from it or the run fine-tunes another one, and the student.
///
/// A resumed run trains what is not complete.
///
/// # Errors
/// When there are no validation subjects, the folder cannot be written or the user interrupts.
pub fn train(context: &RunContext, extra: Extra) -> Result<(), StepError> {
    let config = &context.config;
    if extra.teacher || config.start.is_some() || config.preset.distillation.needs_teacher() {
        train_teacher(context)?;
    }
    train_student(context, distillation::NAME)?;
    if extra.labels_only {
        train_student(context, distillation::LABELS_ONLY)?;
    }
    Ok(())
}
