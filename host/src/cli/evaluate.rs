//! `myointent evaluate`: teacher, float student and integer student on people none has seen.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use super::arguments::{BackendArguments, open_run};
use crate::report::run_report::{self, REPORT};
use crate::report::scores::tables;
use crate::run::evaluate::{evaluate, no_more};
use crate::run::quantize::MODEL;
use crate::student::distillation;

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "TA is transition accuracy with a buffer of 60, 120 or 200 samples around each change. Offsets are of\n\
    the changes that were followed, labels booked at the instant they speak of; `emitted ms` books them when\n\
    the device emits them, look-ahead included. Deviations are over subjects. All numbers, every reading and\n\
    every subject are in results.json of the run folder."
)]
pub struct Arguments {
    /// Run folder that `quantize` has filled.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Model file to judge; the run folder's if not given.
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Print results.json instead of tables.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Judges the run's models and writes results.json and report.html.
///
/// # Errors
/// When a model is missing or damaged.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let context = open_run(&arguments.run, arguments.backend)?;
    let path = arguments
        .model
        .clone()
        .unwrap_or_else(|| context.folder.file(MODEL));
    // A run that has trained a teacher alone is judged too.
    let expected = arguments.model.is_some() || context.has(distillation::NAME);
    let model = expected
        .then(|| std::fs::read(&path))
        .transpose()
        .with_context(|| {
            format!(
                "{}: no model file; run `myointent quantize` first",
                path.display()
            )
        })?;
    let (results, evaluation) = evaluate(&context, model.as_deref(), &no_more)?;
    let page = context.folder.file(REPORT);
    run_report::write(&context, &results, &evaluation, &page)?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&results)?)?;
    } else {
        for table in tables(&results) {
            writeln!(out, "{}", table.plain())?;
        }
        writeln!(out, "left out: {}", results.held_out.join(", "))?;
        writeln!(out, "report: {}", page.display())?;
    }
    Ok(())
}
