//! `myointent export`: the teacher's weights for other programs.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::find_run;
use crate::cli::output::refuse_existing;
use training::backend::BackendArguments;
use training::run::context::load_teacher;
use training::teacher::checkpoint;

/// Arguments of `export`.
#[derive(Debug, Args)]
#[command(
    after_help = "The reference's code reads the file if the run's preset is `paper`. `myointent train --from FILE` reads it\n\
    and the reference's own checkpoints."
)]
pub struct Arguments {
    /// Run folder of `myointent train`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// File to write; there must be none of this name.
    ///
    /// `teacher.safetensors` in the run folder if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Writes the teacher as safetensors.
///
/// # Errors
/// When the run folder holds no teacher or the file cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (mut folder, config) = find_run(&arguments.run)?;
    match &arguments.out {
        Some(out) => refuse_existing(out)?,
        None => folder = folder.locked()?,
    }
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| folder.file("teacher.safetensors"));
    let teacher = load_teacher(&folder, &config, &arguments.backend.device()?.inner())?;
    checkpoint::save(&out, &teacher, &config.subjects_seen())?;
    writeln!(std::io::stdout(), "{}", out.display())?;
    Ok(())
}
