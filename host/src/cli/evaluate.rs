//! `myointent evaluate`: teacher, float student and integer student on held-out subjects.

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
    after_help = "TA is transition accuracy with a buffer of 60, 120 or 200 samples around each transition. Offsets are\n\
    those of the transitions that were followed, each label at its reference time; `emitted ms` takes the\n\
    emission time instead, look-ahead included. Deviations are over subjects. results.json in the run folder\n\
    has all numbers, with every aggregation mode and every subject."
)]
pub struct Arguments {
    /// Run folder of `myointent quantize`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Model file to evaluate; the run folder's if not given.
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Print results.json instead of tables.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Evaluates the run's models and writes results.json and report.html.
///
/// # Errors
/// When a model is missing or damaged.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let context = open_run(&arguments.run, arguments.backend)?;
    let path = arguments
        .model
        .clone()
        .unwrap_or_else(|| context.folder.file(MODEL));
    // A run with a teacher alone is evaluated too.
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
        writeln!(out, "held out: {}", results.held_out.join(", "))?;
        writeln!(out, "report:   {}", page.display())?;
    }
    Ok(())
}
