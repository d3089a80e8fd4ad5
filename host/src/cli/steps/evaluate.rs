//! `myointent evaluate`: a run's models on its held-out subjects, or model files on any recordings.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use crate::cli::arguments::{BackendArguments, open_run, warn_of_test_people};
use crate::cli::evaluate_models;
use crate::run::evaluate::{evaluate, no_more};
use crate::run::quantize::ModelFile;
use evaluation::report::labels::labels;
use evaluation::report::run_report::{self, REPORT};
use evaluation::report::scores::tables;
use recordings::split::circles::is_test;

/// Arguments of `evaluate`.
#[derive(Debug, Args)]
#[command(
    after_help = "balanced: mean recall of the classes present. TA: transition accuracy, share of label changes that are followed within\n\
    half a second either way and held. recognised: share of gestures whose label is emitted and held, and no other.\n\
    latency: median / 90th percentile from muscle onset to the emitted label, look-ahead included, misses counted as\n\
    misses. false/min: false activations a minute of rest. flicker/min: label changes a minute beyond the true\n\
    ones. raw: share of samples. [a, b]: 95 % interval of the mean, from six subjects on. n: subjects of a number, where its\n\
    row has more. classes: subjects with all classes of the model in their recordings, and subjects with fewer, in rows of\n\
    their own. Floors: a constant `relax`, and an\n\
    energy detector fitted to the training subjects. docs/metrics.md has the definitions; results.json in the run folder\n\
    has all numbers, with every aggregation mode and every subject.\n\n\
    Examples:\n  myointent evaluate --run runs/mine\n  \
    myointent evaluate --model models/three-class.intent --data DIR\n  \
    myointent evaluate --model a.intent --model b.intent --data DIR --subjects roshambo,ss-stm/sub3 --csv people.csv\n  \
    myointent evaluate --model a.intent --data DIR --rotate any --align"
)]
pub struct Arguments {
    /// Run folder of `myointent quantize`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Model file to evaluate; the run folder's if not given. The results of another model are printed and not kept. With
    /// --data several may be given.
    #[arg(long, value_name = "FILE")]
    model: Vec<PathBuf>,
    #[command(flatten)]
    models: evaluate_models::Options,
    /// Print JSON instead of tables.
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
    if let Some(data) = &arguments.models.data {
        return evaluate_models::run(&arguments.model, data, &arguments.models, arguments.json);
    }
    let model = match &arguments.model[..] {
        [] => None,
        [path] => Some(path),
        _ => bail!("several models need --data DIR: a run folder is evaluated with one"),
    };
    let context = open_run(&arguments.run, arguments.backend)?;
    // A run with a teacher alone is evaluated too.
    let model = match model {
        Some(path) => Some(ModelFile::read(&context, path)?),
        None => ModelFile::of_run(&context)?,
    };
    let held_out = context.config.split.held_out.iter();
    warn_of_test_people(held_out.filter(|subject| is_test(subject)).count());
    let (results, evaluation) = evaluate(&context, model.as_ref(), &no_more)?;
    let page = context.folder.file(REPORT);
    if evaluation.is_kept {
        run_report::write(
            &context.folder,
            &context.config,
            &results,
            &evaluation,
            &page,
        )?;
    }
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&results)?)?;
    } else {
        for table in tables(&results) {
            writeln!(out, "{}", table.plain())?;
        }
        for (what, how) in labels(&context.config.lags, &results.gestures) {
            writeln!(out, "{what}: {how}")?;
        }
        writeln!(out, "held out: {}", results.held_out.join(", "))?;
        if evaluation.is_kept {
            writeln!(out, "report:   {}", page.display())?;
        } else {
            writeln!(out, "not kept: the model file is not that of this run")?;
        }
    }
    Ok(())
}
