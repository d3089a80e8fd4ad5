//! `myointent quantize`: the model file.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::open_run;
use crate::cli::output::refuse_existing;
use training::backend::BackendArguments;
use training::run::quantize::{MODEL, quantize};

#[derive(Debug, Args)]
pub struct Arguments {
    /// Run folder of `myointent train`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Model file to write; it must not exist.
    ///
    /// `student.intent` in the run folder if not given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArguments,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.out.as_deref().map_or(Ok(()), refuse_existing)?;
    let context = open_run(&arguments.run, arguments.backend)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| context.folder.file(MODEL));
    let bytes = quantize(&context, &out)?;
    writeln!(
        std::io::stdout(),
        "{} ({} bytes)",
        out.display(),
        bytes.len()
    )?;
    Ok(())
}
