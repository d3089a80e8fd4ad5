//! Candidates of an evaluation: the models of a run, and their logits over trials.

use shared::model::LookBackLogits;
use shared::units::CleanSample;

use super::context::RunContext;
use crate::inference::{student_logits, teacher_logits};
use crate::student::model::Student;
use evaluation::{Candidate, Trial};
use execution::parallel;
use execution::run_folder::RunError;

/// Computes the teacher's logits over all trials; `name` is its name in tables.
///
/// # Errors
/// When the teacher is missing, not this run's, or of another shape, or the user interrupts.
pub fn teacher_candidate(
    context: &RunContext,
    name: &str,
    trials: &[Trial],
) -> Result<Candidate, RunError> {
    let model = context.teacher()?;
    let shape = context.config.preset.teacher.window_shape();
    let device = context.inference_device();
    candidate(context, name, trials, |emg| {
        teacher_logits(&model, shape, emg, &device)
    })
}

/// Computes a float student's logits over all trials.
pub(super) fn student_candidate(
    context: &RunContext,
    name: &str,
    student: &Student,
    trials: &[Trial],
) -> Result<Candidate, RunError> {
    let device = context.inference_device();
    candidate(context, name, trials, |emg| {
        student_logits(student, emg, &device)
    })
}

/// Computes a model's logits over all trials, on all cores.
fn candidate(
    context: &RunContext,
    name: &str,
    trials: &[Trial],
    logits: impl Fn(&[CleanSample]) -> Vec<LookBackLogits> + Sync,
) -> Result<Candidate, RunError> {
    let preprocessing = context.config.preset.preprocessing();
    let logits = parallel::map(name, trials, &context.folder, &context.interrupt, |trial| {
        logits(&trial.input(preprocessing))
    })?;
    Ok(Candidate {
        name: name.to_owned(),
        looks_back: true,
        logits,
        entry_margins: context.config.preset.smoother.entry_margins.of_classes(),
        other_margin: context.config.preset.other_margin(),
    })
}
