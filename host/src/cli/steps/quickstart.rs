//! `myointent quickstart`: from recordings to an evaluated model file in one command.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{TrainingArguments, log_labels};
use evaluation::System;
use evaluation::report::run_report;
use evaluation::report::scores::summary;
use execution::progress;
use presets::config::ResolvedConfig;
use training::run::context::RunContext;
use training::run::evaluate::{Results, evaluate};
use training::run::quantize::{MODEL, ModelFile, quantize};
use training::run::train::train;

#[derive(Debug, Args)]
#[command(
    after_help = "The last lines of the output name the recordings and the held-out subjects.\n\n\
    Examples:\n  myointent quickstart --data recordings\n  \
    myointent quickstart --preset cpu --data recordings --run runs/cpu"
)]
pub struct Arguments {
    /// Run folder to write checkpoints, metrics, model file and report to.
    #[arg(long, value_name = "DIR", default_value = "runs/quickstart")]
    run: PathBuf,
    /// Built-in preset or a TOML file; quickstart if not given.
    #[arg(long)]
    preset: Option<String>,
    #[command(flatten)]
    training: TrainingArguments,
}

/// Trains, distils, quantizes, evaluates and writes the report.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let TrainingArguments { data, teacher, .. } = &arguments.training;
    let is_given = arguments.preset.is_some();
    let context = arguments.training.open(&arguments.run, is_given, || {
        let name = arguments.preset.as_deref().unwrap_or("quickstart");
        let (preset, library) = arguments.training.preset(name)?;
        let folder = data.folder();
        let config = ResolvedConfig::new(preset, &library, folder.as_deref(), data.strict, None)?;
        Ok((config, library))
    })?;
    log_start(&context);

    train(&context, *teacher)?;
    let model = context.folder.file(MODEL);
    quantize(&context, &model)?;
    let file = ModelFile::of_run(&context)?;
    let (results, evaluation) = evaluate(&context, file.as_ref())?;
    // Written again, now with the scores in the header.
    quantize(&context, &model)?;
    let page = run_report::write(&context.folder, &context.config, &results, &evaluation)?;

    let recordings = recordings_used(&context);
    let screen = last_screen(&results, &recordings, &model, &page);
    write!(std::io::stdout(), "{screen}")?;
    Ok(())
}

/// Describes where the recordings come from, and how many files were left out.
fn recordings_used(context: &RunContext) -> String {
    let recordings = match &context.config.data {
        Some(path) => path.display().to_string(),
        None => "synthetic".to_owned(),
    };
    match context.library.skipped.len() {
        0 => recordings,
        files => format!("{recordings}; damaged files left out: {files}"),
    }
}

/// Formats the end of the output, at most 20 lines: scores of the model file, and the paths of the results.
fn last_screen(results: &Results, recordings: &str, model: &Path, page: &Path) -> String {
    let (model, page) = (model.display(), page.display());
    format!(
        "{}, held-out subjects, lag-compensated labels: mean (95 % interval)\n\
        {}\n\
        recordings: {recordings}\n\
        held out:   {}\n\
        model file: {model}\n\
        report:     {page}\n\
        next:       myointent replay {model} RECORDING    # the UART lines of the device\n",
        System::Integer,
        summary(results).plain(),
        by_data_set(&results.held_out),
    )
}

/// Formats subjects by data set: `roshambo 03, 06; ss-stm sub3`.
fn by_data_set(subjects: &[String]) -> String {
    let mut sets: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for subject in subjects {
        let (set, name) = subject.split_once('/').unwrap_or(("", subject));
        sets.entry(set).or_default().push(name);
    }
    let sets: Vec<_> = sets
        .into_iter()
        .map(|(set, names)| format!("{set} {}", names.join(", ")))
        .collect();
    sets.join("; ")
}

fn log_start(context: &RunContext) {
    let config = &context.config;
    progress::log(&format!(
        "training on {} subjects: {}",
        config.split.training.len(),
        config.split.training.join(", ")
    ));
    progress::log(&format!("held out: {}", config.split.held_out.join(", ")));
    log_labels(config);
}
