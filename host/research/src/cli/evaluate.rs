//! `myointent-research evaluate`: teacher, baselines and students of a run, side by side.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use myointent::cli::arguments::{BackendArguments, open_run};
use myointent::report::run_report::{self, REPORT};
use myointent::report::scores::tables;
use myointent::run::evaluate::evaluate;
use myointent::run::quantize::MODEL;

use crate::baselines::inference::candidates;

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Run folder whose models are evaluated.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Evaluates the run's models and writes results.json and report.html.
///
/// # Errors
/// When a model is damaged or the folder cannot be written.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let context = open_run(&arguments.run, arguments.backend)?;
    let model = std::fs::read(context.folder.file(MODEL)).ok();
    let (results, evaluation) = evaluate(&context, model.as_deref(), &|trials| {
        Ok(candidates(&context, trials)?)
    })?;
    let page = context.folder.file(REPORT);
    run_report::write(&context, &results, &evaluation, &page)?;
    let mut out = std::io::stdout().lock();
    for table in tables(&results) {
        writeln!(out, "{}", table.plain())?;
    }
    writeln!(out, "report: {}", page.display())?;
    Ok(())
}
