//! Step 2: the student, from the labels and, if the preset says so, the teacher's soft targets.

use shared::units::CleanSample;

use super::context::RunContext;
use super::error::StepError;
use super::preflight::refuse_impossible;
use super::soft_targets::soft_targets;
use crate::student::distillation;
use crate::student::learner::StudentLearner;
use crate::teacher;
use crate::training::fit::fit;

/// Trains the student.
///
/// # Errors
/// When the teacher is missing, the folder cannot be written or the user interrupts.
pub fn distill(context: &RunContext) -> Result<(), StepError> {
    train(context, distillation::NAME)
}

/// Trains a second student on the labels alone, to measure the effect of distillation.
///
/// # Errors
/// When the folder cannot be written or the user interrupts.
pub fn train_on_labels(context: &RunContext) -> Result<(), StepError> {
    train(context, distillation::LABELS_ONLY)
}

fn train(context: &RunContext, name: &'static str) -> Result<(), StepError> {
    let preset = &context.config.preset;
    let config = &context.config.distillation(name);
    refuse_impossible(preset, &context.inference_device())?;
    if config.needs_teacher() && !context.has(teacher::training::NAME) {
        let path = context.folder.weights_path(teacher::training::NAME);
        return Err(StepError::NoTeacher { path });
    }
    let made_from = context.config.student_lineage(name, &context.folder)?;
    let corpus = context.config.training(&context.library);
    let validation = context.config.validation(&context.library);
    if validation.streams.is_empty() {
        return Err(StepError::NoValidation);
    }
    let targets = if config.teacher_share > 0.0 {
        let streams: Vec<&[CleanSample]> = corpus
            .streams
            .iter()
            .map(|stream| stream.emg.as_slice())
            .collect();
        Some(soft_targets(context, &streams)?)
    } else {
        None
    };
    let seed = preset.seed;
    context.device.seed(seed);
    let model = preset
        .student
        .init(preset.classes, preset.other(), &context.device);
    let learner = StudentLearner::new(
        name,
        preset.student.span,
        &corpus,
        targets,
        &validation,
        config,
        &context.device,
    );
    fit(
        &learner,
        model,
        config.train_config(seed),
        &context.training(made_from),
    )?;
    Ok(())
}
