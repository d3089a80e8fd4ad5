//! `myointent predict --run`: the checkpoints of a run folder.

use ::presets::distillation;
use anyhow::Context as _;
use evaluation::inference::input;
use shared::stream::smoother::Settings;
use shared::units::Sample;
use training::inference::{student_logits, teacher_logits};
use training::run::context::{RunContext, load_student, load_teacher};

use crate::cli::predict::{Arguments, Loaded, Which};

/// Loads the checkpoint.
pub(in crate::cli) fn loaded(arguments: &Arguments) -> anyhow::Result<Loaded<'static>> {
    let run = arguments.run.as_deref();
    let (folder, config) = RunContext::find(run.context("no model: give --model or --run")?)?;
    let device = arguments.backend.device()?.inner();
    let (classes, settings) = (config.preset.classes, Settings::PAPER_IN_PATCHES);
    let preprocessing = config.preset.preprocessing();
    let emg = move |samples: &[Sample]| input(samples, preprocessing);
    Ok(match arguments.which {
        Which::Teacher => {
            let model = load_teacher(&folder, &config, &device)?;
            let shape = config.preset.teacher.window_shape();
            Box::new(move |samples| {
                let rows = teacher_logits(&model, shape, &emg(samples), &device);
                Ok((rows, classes, settings))
            })
        }
        Which::Student => {
            let model = load_student(&folder, &config, distillation::NAME, &device)?;
            Box::new(move |samples| {
                let rows = student_logits(&model, &emg(samples), &device);
                Ok((rows, classes, settings))
            })
        }
    })
}
