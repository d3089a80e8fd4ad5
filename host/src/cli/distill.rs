//! `myointent distill`: the student.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{BackendArguments, open_run};
use crate::run::context::RunContext;
use crate::run::distill;
use crate::student::distillation;

/// Arguments of `distill`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Run folder of `myointent train`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Weight of the soft targets in the loss, instead of the preset's; 0 trains on the labels alone.
    #[arg(long, value_name = "0..1", value_parser = share)]
    teacher_share: Option<f64>,
    /// Train a second student on the labels alone, for comparison with the distilled one.
    #[arg(long, conflicts_with = "teacher_share")]
    labels_only: bool,
    /// Continue after the last complete epoch.
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    backend: BackendArguments,
}

fn share(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|share| (0.0..=1.0).contains(share))
        .ok_or_else(|| format!("expected 0 to 1, found {text}"))
}

/// Trains the student.
///
/// # Errors
/// When the run folder holds no teacher or cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut context = RunContext {
        resume: arguments.resume,
        ..open_run(&arguments.run, arguments.backend)?
    };
    if let Some(share) = arguments.teacher_share {
        context.config.preset.distillation.teacher_share = share;
        context.config.save(&context.folder)?;
    }
    let name = if arguments.labels_only {
        distill::train_on_labels(&context)?;
        distillation::LABELS_ONLY
    } else {
        distill::distill(&context)?;
        distillation::NAME
    };
    println!("{}", context.folder.weights_path(name).display());
    Ok(())
}
