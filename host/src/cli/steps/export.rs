//! `myointent export`: the teacher's weights for other programs.

use std::path::PathBuf;

use clap::Args;

use crate::cli::arguments::{BackendArguments, open_run};
use crate::teacher::checkpoint;

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
    /// File to write; `teacher.safetensors` in the run folder if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Writes the teacher as safetensors.
///
/// # Errors
/// When the run folder holds no teacher or the file cannot be written.
pub(in crate::cli) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let context = open_run(&arguments.run, arguments.backend)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| context.folder.file("teacher.safetensors"));
    checkpoint::save(&out, &context.teacher()?, &context.config.subjects_seen())?;
    println!("{}", out.display());
    Ok(())
}
