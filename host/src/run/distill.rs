//! Step 2: the student, from the labels and, if the preset says so, the teacher's soft targets.

use shared::units::CleanSample;

use super::context::RunContext;
use super::error::StepError;
use super::quantize::{AGGREGATION, FIGURES};
use super::soft_targets::soft_targets;
use crate::student::distillation::{self, Distillation};

/// Trains the student.
///
/// # Errors
/// When the teacher is missing, the folder cannot be written or the user interrupts.
pub fn distill(context: &RunContext) -> Result<(), StepError> {
    if !context.resume {
        context.folder.forget(&[AGGREGATION, FIGURES])?;
    }
    train(
        context,
        distillation::NAME,
        &context.config.preset.distillation,
    )
}

/// Trains a second student on the labels alone: the difference is what distillation buys.
///
/// # Errors
/// When the folder cannot be written or the user interrupts.
pub fn train_on_labels(context: &RunContext) -> Result<(), StepError> {
    let labels_alone = Distillation {
        teacher_share: 0.0,
        ..context.config.preset.distillation.clone()
    };
    train(context, distillation::LABELS_ONLY, &labels_alone)
}

fn train(context: &RunContext, name: &'static str, config: &Distillation) -> Result<(), StepError> {
    let preset = &context.config.preset;
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
    context.device.seed(preset.seed);
    let model = preset.student.init(preset.classes, &context.device);
    distillation::train(
        name,
        model,
        preset.student.span,
        &corpus,
        targets,
        &validation,
        config,
        preset.seed,
        &context.device,
        &context.folder,
        context.resume,
        &context.interrupt,
    )?;
    Ok(())
}
