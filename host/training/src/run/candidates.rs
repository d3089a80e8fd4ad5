//! Candidates of an evaluation: the models of a run, and their logits over recordings.

use shared::model::LookBackLogits;
use shared::stream::smoother::AggregationMode;
use shared::units::CleanSample;

use super::context::RunContext;
use crate::inference::{student_logits, teacher_logits};
use crate::student::model::Student;
use evaluation::{Candidate, EvaluatedRecording, System};
use execution::progress;
use execution::run_folder::RunError;

/// Computes the teacher's logits over all recordings; `system` names it in tables.
pub fn teacher_candidate(
    context: &RunContext,
    system: System,
    recordings: &[EvaluatedRecording],
) -> Result<Candidate, RunError> {
    let model = context.teacher()?;
    let shape = context.config.preset.teacher.window_shape();
    let device = context.inference_device();
    candidate(context, system, recordings, |emg| {
        teacher_logits(&model, shape, emg, &device)
    })
}

/// Computes a float student's logits over all recordings.
pub(super) fn student_candidate(
    context: &RunContext,
    system: System,
    student: &Student,
    recordings: &[EvaluatedRecording],
) -> Result<Candidate, RunError> {
    let device = context.inference_device();
    candidate(context, system, recordings, |emg| {
        student_logits(student, emg, &device)
    })
}

/// Computes a model's logits over all recordings, on all cores.
fn candidate(
    context: &RunContext,
    system: System,
    recordings: &[EvaluatedRecording],
    logits: impl Fn(&[CleanSample]) -> Vec<LookBackLogits> + Sync,
) -> Result<Candidate, RunError> {
    let preprocessing = context.config.preset.preprocessing();
    let logits = progress::map(
        &system.name(),
        recordings,
        &context.folder,
        &context.interrupt,
        |recording| logits(&recording.input(preprocessing)),
    )?;
    // The aggregation mode is a condition of the evaluation.
    let smoother = context
        .config
        .preset
        .smoother_defaults(AggregationMode::AllRowsFrom);
    Ok(Candidate::new(system, logits, &smoother))
}
