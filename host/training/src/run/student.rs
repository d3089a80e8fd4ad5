//! Training of the student on the labels and, if the preset says so, on soft targets of the teacher or of an ensemble.

use burn::module::Module as _;
use shared::units::CleanSample;

use super::context::RunContext;
use super::error::StepError;
use super::quantize::refuse_impossible;
use super::soft_targets::soft_targets;
use crate::optimization::fit::fit;
use crate::student::ensemble::Ensemble;
use crate::student::learner::{StudentLearner, Teaching};
use crate::student::model::Student;
use presets::distillation::{MEMBERS, NAME};
use recordings::corpus::Corpus;

/// Streams of a run's students.
struct Streams {
    training: Corpus,
    validation: Corpus,
}

/// Trains the student. First trains the ensemble that it learns from, if there is one.
pub(super) fn train_student(context: &RunContext) -> Result<(), StepError> {
    let config = &context.config.preset.distillation;
    refuse_impossible(&context.config.preset, &context.inference_device())?;
    if config.needs_teacher() {
        // A teacher of another run is refused before the streams are made.
        context.config.teaching_weights(&context.folder)?;
    }
    let streams = Streams {
        training: context.config.training(&context.library),
        validation: context.config.validation(&context.library),
    };
    if streams.validation.streams.is_empty() {
        return Err(StepError::NoValidation);
    }
    if config.needs_teacher() {
        let all = streams.training.streams.iter();
        let emg: Vec<&[CleanSample]> = all.map(|stream| stream.emg.as_slice()).collect();
        let targets = soft_targets(context, &emg)?;
        student(context, NAME, &streams, Teaching::Teacher(targets))?;
    } else if let Some(ensemble) = config.teaching_ensemble() {
        let members = MEMBERS[..ensemble.members].iter().map(|&member| {
            student(context, member, &streams, Teaching::Labels).map(|student| student.valid())
        });
        let trained = members.collect::<Result<_, _>>()?;
        let ensemble = Ensemble::new(trained);
        student(context, NAME, &streams, Teaching::Ensemble(&ensemble))?;
    } else {
        student(context, NAME, &streams, Teaching::Labels)?;
    }
    Ok(())
}

/// Trains a student of this name.
fn student(
    context: &RunContext,
    name: &'static str,
    streams: &Streams,
    teaching: Teaching<'_>,
) -> Result<Student, StepError> {
    let preset = &context.config.preset;
    let config = &context.config.distillation(name);
    let seed = context.config.student_seed(name);
    let made_from = context.config.student_lineage(name, &context.folder)?;
    let (device, other) = (&context.device, preset.other());
    let model = Student::new(seed, &preset.student, preset.classes, other, device);
    let learner = StudentLearner::new(
        name,
        preset.student.span,
        &streams.training,
        teaching,
        &streams.validation,
        config,
        device,
    );
    Ok(fit(
        &learner,
        model,
        config.train_config(seed),
        &context.training(made_from),
    )?)
}
