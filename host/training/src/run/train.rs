//! Training of a run's models: what the preset asks for, and what is asked beyond it.

use std::path::Path;

use super::context::RunContext;
use super::error::StepError;
use super::quantize::refuse_impossible;
use super::student::train_student;
use crate::teacher;
use crate::teacher::learner::TeacherLearner;
use crate::teacher::model::Teacher;
use crate::weights::{load_model, save_model};
use execution::progress;
use presets::lineage;

/// Trains the models of a run: the teacher if the student learns from it, the run fine-tunes another one or `teacher` is set, and
/// the student.
///
/// A resumed run trains what is not complete.
pub fn train(context: &RunContext, teacher: bool) -> Result<(), StepError> {
    let config = &context.config;
    if teacher || config.start.is_some() || config.preset.distillation.needs_teacher() {
        train_teacher(context)?;
    }
    train_student(context)
}

/// Trains the teacher.
pub fn train_teacher(context: &RunContext) -> Result<(), StepError> {
    let preset = &context.config.preset;
    let corpus = context.config.training(&context.library);
    let validation = context.config.validation(&context.library);
    refuse_impossible(preset, &context.inference_device())?;
    if validation.streams.is_empty() {
        return Err(StepError::NoValidation);
    }
    progress::log(&format!(
        "training on {} streams, {:.0} s; validating on {}, {:.0} s",
        corpus.streams.len(),
        corpus.seconds(),
        validation.streams.len(),
        validation.seconds(),
    ));
    let made_from = context.config.teacher_lineage();
    let device = &context.device;
    let mut model = Teacher::new(preset.seed, &preset.teacher, preset.classes, device);
    if let Some(start) = &context.config.start {
        if lineage::start_weights(start).ok() != context.config.start_weights {
            let start = start.clone();
            return Err(StepError::StartChanged { start });
        }
        model = load_start(start, model)?;
    }
    if preset.teacher_training.epochs == 0 {
        save_model(&context.folder, presets::teacher::NAME, made_from, &model)?;
        return Ok(());
    }
    let learner = TeacherLearner::new(
        preset.teacher.window_shape(),
        &corpus,
        &validation,
        &preset.teacher_training,
        preset.seed,
        device,
    );
    learner.train(model, &context.training(made_from))?;
    Ok(())
}

/// Loads the weights that training starts from: another run's teacher, or a checkpoint in the reference's format.
fn load_start(start: &Path, model: Teacher) -> Result<Teacher, StepError> {
    if start.is_dir() {
        let (folder, origin) = RunContext::find(start)?;
        let made_from = origin.teacher_lineage();
        return Ok(load_model(
            &folder,
            presets::teacher::NAME,
            made_from,
            model,
        )?);
    }
    Ok(teacher::checkpoint::load(start, model)?)
}
