//! `myointent distill`: the student.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::open_run;
use presets::distillation;
use training::backend::BackendArguments;
use training::run::context::RunContext;
use training::run::distill;

/// Arguments of `distill`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Run folder of `myointent train`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Weight of the soft targets in the loss, instead of the preset's (cpu 0.8, quickstart and paper 0.5); 0 trains on the
    /// labels alone.
    ///
    /// Changes the run's configuration: results and model file of the student before are no longer this run's.
    #[arg(long, value_name = "0..1", value_parser = share)]
    teacher_share: Option<f64>,
    /// Train a second student on the labels alone, for comparison with the distilled one.
    #[arg(long, conflicts_with = "teacher_share")]
    labels_only: bool,
    /// Continue after the last checkpoint.
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
pub(in crate::cli) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut context = RunContext {
        resume: arguments.resume,
        ..open_run(&arguments.run, arguments.backend)?
    };
    if let Some(share) = arguments.teacher_share {
        let mut config = context.config.clone();
        config.preset.distillation.teacher_share = share;
        if arguments.resume {
            context.config.must_equal(&config, &context.folder)?;
        } else {
            // Another student gives other results; the teacher stays the same.
            config.save(&context.folder)?;
            context.config = config;
        }
    }
    let name = if arguments.labels_only {
        distill::train_on_labels(&context)?;
        distillation::LABELS_ONLY
    } else {
        distill::distill(&context)?;
        distillation::NAME
    };
    let weights = context.folder.weights_path(name);
    writeln!(std::io::stdout(), "{}", weights.display())?;
    Ok(())
}
