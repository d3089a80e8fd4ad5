//! `myointent quantize`: the model file.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{BackendArguments, Begun};
use crate::execution::interrupt::Interrupt;

/// Arguments of `quantize`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Run folder that `distill` has filled.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Model file to write; `student.intent` in the run folder if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Writes the model file.
///
/// # Errors
/// When the run folder holds no student or the file cannot be written.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let run = Begun::open(&arguments.run)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| run.folder.file(super::quickstart::MODEL));
    let stage = run.stage(&arguments.backend, false, &interrupt);
    let bytes = stage.quantize(&out)?;
    println!("{} ({} bytes)", out.display(), bytes.len());
    Ok(())
}
