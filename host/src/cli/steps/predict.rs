//! `myointent predict --run`: the checkpoints of a run folder.

use ::presets::{distillation, teacher};
use anyhow::Context as _;
use evaluation::inference::input;
use shared::stream::smoother::Settings;
use training::run::context::{RunContext, load_logits};

use crate::cli::predict::{Arguments, Loaded, Which};

/// Loads the checkpoint.
pub(in crate::cli) fn loaded(arguments: &Arguments) -> anyhow::Result<Loaded<'static>> {
    let run = arguments.run.as_deref();
    let (folder, config) = RunContext::find(run.context("no model: give --model or --run")?)?;
    let device = arguments.backend.device()?.inner();
    let (classes, settings) = (config.preset.classes, Settings::PAPER_IN_PATCHES);
    let preprocessing = config.preset.preprocessing();
    let name = match arguments.which {
        Which::Teacher => teacher::NAME,
        Which::Student => distillation::NAME,
    };
    let logits = load_logits(&folder, &config, name, device)?;
    Ok(Box::new(move |samples| {
        let rows = logits(&input(samples, preprocessing));
        Ok((rows, classes, settings))
    }))
}
