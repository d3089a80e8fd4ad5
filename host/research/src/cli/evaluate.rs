//! `myointent-research evaluate`: teacher, baselines and students of a run, side by side.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;

use evaluation::model_evaluation::{NamedModel, beside};
use evaluation::report::run_report::{self, REPORT};
use evaluation::report::scores::tables;
use myointent::cli::steps::open_run;
use training::backend::BackendArguments;
use training::run::evaluate::evaluate;
use training::run::quantize::ModelFile;

use crate::baselines::inference::candidates;

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "Evaluates what the run folder has: teacher, baselines, float student, integer student. Metrics are those of\n\
    `myointent evaluate`, which evaluates no baselines. Writes results.json and report.html.\n\n\
    Examples:\n  myointent-research evaluate --run runs/mine\n  \
    myointent-research evaluate --run runs/comparison --model models/three-class.intent --model runs/quickstart/student.intent"
)]
pub(super) struct Arguments {
    /// Run folder.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Further model files, evaluated beside; refused if one has seen somebody whom the run holds out.
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Evaluates the run's models, writes results.json and report.html and prints the tables.
///
/// # Errors
/// When a model is damaged or the folder cannot be written.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let context = open_run(&arguments.run, arguments.backend)?;
    // A run may have baselines alone.
    let model = ModelFile::of_run(&context)?;
    let models = arguments
        .model
        .iter()
        .map(|path| NamedModel::read(path).with_context(|| path.display().to_string()))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let (results, judged) = evaluate(&context, model.as_ref(), &|recordings| {
        let mut more = candidates(&context, recordings)?;
        for model in &models {
            more.push(beside(model, recordings)?);
        }
        Ok(more)
    })?;
    let page = context.folder.file(REPORT);
    run_report::write(&context.folder, &context.config, &results, &judged, &page)?;
    let mut out = std::io::stdout().lock();
    for table in tables(&results, true) {
        writeln!(out, "{}", table.plain())?;
    }
    writeln!(out, "held out: {}", results.held_out.join(", "))?;
    writeln!(out, "report: {}", page.display())?;
    Ok(())
}
