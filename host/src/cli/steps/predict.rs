//! `myointent predict --run`: the checkpoints of a run folder.

use ::presets::augmentation::Variation;
use ::presets::config::ResolvedConfig;
use ::presets::distillation;
use anyhow::Context as _;
use evaluation::inference::input;
use execution::run_folder::RunFolder;
use shared::stream::smoother::Settings;
use shared::units::{CHANNELS, Sample, WINDOW};
use training::inference::{student_logits, teacher_logits};
use training::optimization::read_back;
use training::run::context::{RunContext, load_student, load_teacher};
use training::teacher::model::TeacherInput;

use crate::cli::predict::{Arguments, Loaded, Matrix, Which, names};

/// Loads the checkpoint.
///
/// # Errors
/// When the folder holds no such checkpoint.
pub(in crate::cli) fn loaded(arguments: &Arguments) -> anyhow::Result<Loaded<'static>> {
    let (folder, config) = run_of(arguments)?;
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

/// Computes the teacher's logits of all samples of a window, MASK last.
///
/// # Errors
/// When the folder holds no teacher.
pub(in crate::cli) fn over_window_of_teacher(
    arguments: &Arguments,
    samples: &[Sample],
) -> anyhow::Result<Matrix> {
    let (folder, config) = run_of(arguments)?;
    let device = arguments.backend.device()?.inner();
    let classes = config.preset.classes;
    let model = load_teacher(&folder, &config, &device)?;
    let shape = config.preset.teacher.window_shape();
    let emg = input(samples, config.preset.preprocessing());
    let mut values = Vec::with_capacity(shape.window * CHANNELS);
    // A model with a shorter window takes the newest samples of this one.
    Variation::NONE.write(&emg[WINDOW - shape.window..], &mut values);
    let output = model.forward(TeacherInput::for_inference(values, shape, classes, &device));
    let columns = names(classes, String::new())
        .chain(["mask".to_owned()])
        .collect();
    Ok(Matrix {
        columns,
        values: read_back(output.intent),
    })
}

fn run_of(arguments: &Arguments) -> anyhow::Result<(RunFolder, ResolvedConfig)> {
    let path = arguments
        .run
        .as_deref()
        .context("no model: give --model or --run")?;
    Ok(RunContext::find(path)?)
}
