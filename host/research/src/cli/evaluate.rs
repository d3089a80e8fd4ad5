//! `myointent-research evaluate`: teacher, baselines and students of a run, side by side.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use myointent::cli::arguments::{BackendArguments, open_run};
use myointent::report::run_report::{self, REPORT};
use myointent::report::scores::tables;
use myointent::run::evaluate::evaluate;
use myointent::run::quantize::ModelFile;

use crate::baselines::inference::candidates;

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Evaluates what the run folder has: teacher, baselines, float student, integer student. Metrics are those of\n\
    `myointent evaluate`, which evaluates no baselines. Writes results.json and report.html.\n\n\
    Example:\n  myointent-research evaluate --run runs/mine"
)]
pub(super) struct Arguments {
    /// Run folder.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Evaluates the run's models, writes results.json and report.html and prints the tables.
///
/// # Errors
/// When a model is damaged or the folder cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let context = open_run(&arguments.run, arguments.backend)?;
    // A run with baselines alone is evaluated too.
    let model = ModelFile::of_run(&context)?;
    let (results, judged) = evaluate(&context, model.as_ref(), &|trials| {
        Ok(candidates(&context, trials)?)
    })?;
    let page = context.folder.file(REPORT);
    run_report::write(&context, &results, &judged, &page)?;
    let mut out = std::io::stdout().lock();
    for table in tables(&results) {
        writeln!(out, "{}", table.plain())?;
    }
    writeln!(out, "held out: {}", results.held_out.join(", "))?;
    writeln!(out, "report: {}", page.display())?;
    Ok(())
}
