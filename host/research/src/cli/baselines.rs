//! `myointent-research baselines`: the paper's five baselines.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use myointent::cli::arguments::{BackendArguments, DataArguments, open_run};
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::RunFolder;
use myointent::run::config::ResolvedConfig;
use myointent::run::context::RunContext;
use myointent::run::preset::Preset;

use crate::baselines::training::train_all;
use crate::baselines::{Baseline, find_preset};

/// Arguments of `baselines`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent-research baselines --run runs/mine                  on the run that `myointent train` began\n  \
    myointent-research baselines --run runs/mine --only lda,mlp\n  \
    myointent-research baselines --run runs/baselines --begin --data recordings   a run without a teacher\n\n\
    `myointent-research evaluate` evaluates every baseline of the folder beside teacher and students."
)]
pub struct Arguments {
    /// Run folder whose plan (recordings, split, labels, seed) the baselines are trained on.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Which baselines; all five if not given.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    only: Vec<Baseline>,
    /// Preset whose `[baselines]` say how they are trained: study, paper, or a TOML file.
    #[arg(long, default_value = "study")]
    preset: String,
    /// Begin a run in the folder with that preset.
    #[arg(long, conflicts_with = "resume")]
    begin: bool,
    /// Go on after the last complete epoch; baselines that are complete are left as they are.
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Trains the baselines.
///
/// # Errors
/// When the run folder holds no plan, or one already where a run was to begin, or cannot be written.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (preset, settings) = find_preset(&arguments.preset)?;
    let context = RunContext {
        resume: arguments.resume,
        ..context(arguments, preset)?
    };
    progress::log(&format!(
        "left out: {}",
        context.config.split.held_out.join(", ")
    ));
    let mut baselines = Baseline::ALL.to_vec();
    baselines.retain(|baseline| arguments.only.is_empty() || arguments.only.contains(baseline));
    train_all(&context, &baselines, &settings)?;
    for baseline in baselines {
        println!("{}", context.folder.file(&baseline.model_file()).display());
    }
    Ok(())
}

/// The run in the folder, or a new one.
fn context(arguments: &Arguments, preset: Preset) -> anyhow::Result<RunContext> {
    if !arguments.begin {
        return open_run(&arguments.run, arguments.backend);
    }
    let folder = RunFolder::open(&arguments.run)?;
    if ResolvedConfig::load(&folder).is_ok() {
        bail!(
            "a run has begun in {}: leave --begin away to train on its recordings, or give another folder",
            arguments.run.display()
        );
    }
    let library = arguments.data.load(&preset)?;
    let data = arguments.data.data.as_deref();
    let config = ResolvedConfig::new(preset, &library, data, arguments.data.strict, None)?;
    Ok(RunContext {
        interrupt: Interrupt::listen(),
        ..RunContext::begin(folder, config, library, arguments.backend.device())?
    })
}
