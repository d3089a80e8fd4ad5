//! `myointent-research baselines`: the paper's five baselines.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunFolder;
use myointent::cli::steps::{DataArguments, open_run};
use presets::Preset;
use presets::config::ResolvedConfig;
use training::backend::BackendArguments;
use training::run::context::RunContext;

use crate::baselines::Baseline;
use crate::baselines::settings::find_preset;
use crate::baselines::training::train_all;

/// Arguments of `baselines`.
#[derive(Debug, Args)]
#[command(
    after_help = "Recordings, split, label lag and seed are those of the run; the table `[baselines]` of --preset has the\n\
    training settings. The models are saved in the run folder; `myointent-research evaluate` evaluates them beside\n\
    teacher and students.\n\n\
    Examples:\n  \
    myointent-research baselines --run runs/mine                  on a run of `myointent train`\n  \
    myointent-research baselines --run runs/mine --only lda,mlp\n  \
    myointent-research baselines --run runs/baselines --preset comparison --begin --data recordings\n                                                                \
    in a new run, without a teacher"
)]
pub(super) struct Arguments {
    /// Run folder, of `myointent train` or of an earlier --begin.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Baselines; all five if not given.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    only: Vec<Baseline>,
    /// Preset with the training settings: comparison, a preset of `myointent`, or a TOML file. Without a table
    /// `[baselines]` they are the reference's.
    #[arg(long, default_value = "comparison")]
    preset: String,
    /// Begin a new run in the folder, with --preset and --data.
    #[arg(long, conflicts_with = "resume")]
    begin: bool,
    /// Continue after the last complete epoch; complete baselines stay as they are.
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
/// When the folder has no run, or already has one and `--begin` is given, or when training fails.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (preset, settings) = find_preset(&arguments.preset)?;
    let context = RunContext {
        resume: arguments.resume,
        ..context(arguments, preset)?
    };
    progress::log(&format!(
        "held out: {}",
        context.config.split.held_out.join(", ")
    ));
    let mut baselines = Baseline::ALL.to_vec();
    baselines.retain(|baseline| arguments.only.is_empty() || arguments.only.contains(baseline));
    train_all(&context, &baselines, &settings)?;
    for baseline in baselines {
        let model = context.folder.file(&baseline.model_file());
        writeln!(std::io::stdout(), "{}", model.display())?;
    }
    Ok(())
}

/// Opens the run in the folder, or begins a new one.
fn context(arguments: &Arguments, preset: Preset) -> anyhow::Result<RunContext> {
    if !arguments.begin {
        return open_run(&arguments.run, arguments.backend);
    }
    let folder = RunFolder::open(&arguments.run)?;
    if ResolvedConfig::load(&folder).is_ok() {
        bail!(
            "{} already has a run: leave out --begin to train on its recordings, or give another folder",
            arguments.run.display()
        );
    }
    let device = arguments.backend.device()?;
    let library = arguments.data.load(&preset)?;
    let data = arguments.data.folder();
    let config = ResolvedConfig::new(
        preset,
        &library,
        data.as_deref(),
        arguments.data.strict,
        None,
    )?;
    Ok(RunContext {
        interrupt: Interrupt::listen(),
        ..RunContext::begin(folder, config, library, device)?
    })
}
