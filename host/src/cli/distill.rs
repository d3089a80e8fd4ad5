//! `myointent distill`: the student.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{BackendArguments, Begun};
use crate::execution::interrupt::Interrupt;
use crate::student::distillation;

/// Arguments of `distill`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Run folder that `train` has filled.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Share of the teacher's word against the labels', instead of the preset's; 0 trains on labels alone.
    #[arg(long, value_name = "0..1", value_parser = share)]
    teacher_share: Option<f64>,
    /// Train a second student on the labels alone, beside the one with a teacher, for comparison.
    #[arg(long, conflicts_with = "teacher_share")]
    alone: bool,
    /// Go on after the last complete epoch.
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
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let mut run = Begun::open(&arguments.run)?;
    if let Some(share) = arguments.teacher_share {
        run.plan.preset.distillation.teacher_share = share;
        run.plan.save(&run.folder)?;
    }
    let stage = run.stage(&arguments.backend, arguments.resume, &interrupt);
    let name = if arguments.alone {
        stage.train_alone()?;
        distillation::ALONE
    } else {
        stage.distill()?;
        distillation::NAME
    };
    println!("{}", run.folder.model(name).display());
    Ok(())
}
