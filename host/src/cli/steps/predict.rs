//! `myointent predict --run`: the checkpoints of a run folder.

use ::presets::augmentation::Variation;
use ::presets::config::ResolvedConfig;
use ::presets::distillation;
use anyhow::Context as _;
use evaluation::inference::input;
use execution::run_folder::RunFolder;
use shared::model::LookBackLogits;
use shared::stream::smoother::Settings;
use shared::units::{CHANNELS, Sample, WINDOW};
use training::inference::{student_logits, teacher_logits};
use training::optimization::tensor::read_back;
use training::run::context::{RunContext, load_student, load_teacher};
use training::teacher::model::TeacherInput;

use crate::cli::predict::{Arguments, Matrix, Which, names};

/// Computes the logits of every patch; also returns the number of classes and the smoother's settings.
///
/// # Errors
/// When the folder holds no such checkpoint.
pub(in crate::cli) fn logits(
    arguments: &Arguments,
    samples: &[Sample],
) -> anyhow::Result<(Vec<LookBackLogits>, usize, Settings)> {
    let (folder, config) = run_of(arguments)?;
    let device = arguments.backend.device()?.inner();
    let classes = config.preset.classes;
    let emg = &input(samples, config.preset.preprocessing());
    let rows = match arguments.which {
        Which::Teacher => {
            let model = load_teacher(&folder, &config, &device)?;
            teacher_logits(&model, config.preset.teacher.window_shape(), emg, &device)
        }
        Which::Student => {
            let model = load_student(&folder, &config, distillation::NAME, &device)?;
            student_logits(&model, emg, &device)
        }
    };
    Ok((rows, classes, Settings::PAPER_IN_PATCHES))
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
