//! `myointent quickstart`: from recordings to a judged model file in one go.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use shared::units::SAMPLE_PERIOD_MS;

use super::arguments::{BackendArguments, DataArguments, recordings};
use crate::execution::interrupt::Interrupt;
use crate::execution::progress;
use crate::execution::run_folder::RunFolder;
use crate::report::run_report::{self, REPORT};
use crate::report::scores::{summary, tables};
use crate::run::config::ResolvedConfig;
use crate::run::context::RunContext;
use crate::run::distill::distill;
use crate::run::evaluate::{INTEGER, evaluate, no_more};
use crate::run::preset::Preset;
use crate::run::quantize::{MODEL, quantize};
use crate::run::train::train;

/// Where recordings are looked for when none are given.
const USUAL_PLACES: [&str; 2] = ["data", "../shared/data"];

/// Arguments of `quickstart`.
#[derive(Debug, Args)]
#[command(
    after_help = "Recordings are taken from --data, else MYOINTENT_DATA, else ./data or ../shared/data; without any,\n\
    synthetic ones are made. The output says which, and who was left out."
)]
pub struct Arguments {
    /// Folder for checkpoints, metrics, model file and report.
    #[arg(long, value_name = "DIR", default_value = "runs/quickstart")]
    run: PathBuf,
    /// Built-in preset or a TOML file.
    #[arg(long, default_value = "quickstart")]
    preset: String,
    /// Seed of everything drawn, instead of the preset's.
    #[arg(long)]
    seed: Option<u64>,
    /// Go on where an interrupted quickstart of this run folder stopped.
    #[arg(long)]
    resume: bool,
    /// Train the teacher even if the preset's student does not learn from it.
    #[arg(long)]
    teacher: bool,
    /// Print all tables.
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Trains, distils, quantizes, judges and reports.
///
/// # Errors
/// When recordings, preset or folder cannot be used.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut preset = Preset::find(&arguments.preset)?;
    preset.seed = arguments.seed.unwrap_or(preset.seed);
    let found = USUAL_PLACES
        .iter()
        .map(Path::new)
        .find(|place| place.is_dir());
    let data = arguments.data.data.as_deref().or(found);
    let context = begin(arguments, preset, data)?;
    log_beginning(&context);

    if arguments.teacher || context.config.preset.distillation.teacher_share > 0.0 {
        train(&context)?;
    }
    distill(&context)?;
    let model = context.folder.file(MODEL);
    let bytes = quantize(&context, &model)?;
    let (results, evaluation) = evaluate(&context, Some(&bytes), &no_more)?;
    // Once more, now that there are measurements to put beside the weights.
    quantize(&context, &model)?;
    let page = context.folder.file(REPORT);
    run_report::write(&context, &results, &evaluation, &page)?;

    let mut out = std::io::stdout().lock();
    if arguments.verbose {
        for table in tables(&results) {
            writeln!(out, "{}", table.plain())?;
        }
    }
    let recordings = data.map_or_else(|| "synthetic".to_owned(), |path| path.display().to_string());
    writeln!(
        out,
        "{INTEGER}, lag-compensated labels, mean (deviation) over people it has never seen:\n\n{}",
        summary(&results, INTEGER).plain()
    )?;
    writeln!(out, "recordings: {recordings}")?;
    writeln!(out, "left out:   {}", results.held_out.join(", "))?;
    writeln!(out, "model file: {}", model.display())?;
    writeln!(out, "report:     {}", page.display())?;
    writeln!(
        out,
        "next:       myointent replay {} RECORDING    # the lines that a board would write",
        model.display()
    )?;
    Ok(())
}

fn begin(arguments: &Arguments, preset: Preset, data: Option<&Path>) -> anyhow::Result<RunContext> {
    let strict = arguments.data.strict;
    let library = recordings(data, strict, &preset)?;
    let folder = RunFolder::open(&arguments.run)?;
    let config = if arguments.resume {
        ResolvedConfig::load(&folder)?
    } else {
        ResolvedConfig::new(preset, &library, data, strict, None)?
    };
    Ok(RunContext {
        resume: arguments.resume,
        interrupt: Interrupt::listen(),
        ..RunContext::begin(folder, config, library, arguments.backend.device())?
    })
}

fn log_beginning(context: &RunContext) {
    let config = &context.config;
    progress::log(&format!(
        "training on {} subjects: {}",
        config.split.training.len(),
        config.split.training.join(", ")
    ));
    progress::log(&format!(
        "left out, never trained on: {}",
        config.split.held_out.join(", ")
    ));
    for (data_set, lag) in &config.lags {
        progress::log(&format!(
            "labels of {} are moved by {} ms",
            data_set.name(),
            lag.samples * SAMPLE_PERIOD_MS as usize
        ));
    }
}
