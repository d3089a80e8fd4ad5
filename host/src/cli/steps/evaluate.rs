//! `myointent evaluate`: teacher, float student and integer student on held-out subjects.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use crate::cli::arguments::{BackendArguments, open_run};
use crate::report::run_report::{self, REPORT};
use crate::report::scores::tables;
use crate::run::evaluate::{evaluate, no_more};
use crate::run::quantize::MODEL;
use crate::student::distillation;

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "balanced: mean recall of the classes present. TA: transition accuracy, share of label changes that are followed within\n\
    half a second either way and held. recognised: share of gestures whose label is emitted and held, and no other.\n\
    latency: median / 90th percentile from muscle onset to the emitted label, look-ahead included, misses counted as\n\
    misses. false/min: false activations a minute of rest. flicker/min: label changes a minute beyond the true\n\
    ones. raw: share of samples. [a, b]: 95 % interval of the mean over subjects. Floors: a constant `relax`, and an\n\
    energy detector fitted to the training subjects. docs/metrics.md has the definitions; results.json in the run folder\n\
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
pub(in crate::cli) fn run(arguments: &Arguments) -> anyhow::Result<()> {
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
