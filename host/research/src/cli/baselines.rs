//! `myointent peers`: the paper's five baselines.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::arguments::{BackendArguments, Begun, DataArguments};
use myointent::execution::interrupt::Interrupt;
use crate::baselines::Peer;
use myointent::run::plan::Plan;
use myointent::run::preset::Preset;
use myointent::execution::run_folder::RunFolder;

/// Arguments of `peers`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent peers --run runs/mine                  on the plan that `train` began\n  \
    myointent peers --run runs/mine --only lda,mlp\n  \
    myointent peers --run runs/peers --preset cpu --data recordings   a run without a teacher\n\n\
    `myointent evaluate` judges every peer of the folder beside teacher and students."
)]
pub struct Arguments {
    /// Run folder whose plan (recordings, split, labels, seed) the peers are trained on.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Which peers; all five if not given.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAMES")]
    only: Vec<Peer>,
    /// Begin a run in the folder, with a built-in preset (quickstart, cpu, paper) or a TOML file.
    #[arg(long, conflicts_with = "resume")]
    preset: Option<String>,
    /// Go on after the last complete epoch; peers that are complete are left as they are.
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Trains the peers.
///
/// # Errors
/// When the run folder holds no plan, or one already where a run was to begin, or cannot be written.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let run = match &arguments.preset {
        None => Begun::open(&arguments.run)?,
        Some(preset) => {
            let folder = RunFolder::open(&arguments.run)?;
            if Plan::load(&folder).is_ok() {
                bail!(
                    "a run has begun in {}: leave --preset away to train on its plan, or give another folder",
                    arguments.run.display()
                );
            }
            let preset = Preset::find(preset)?;
            let library = arguments.data.load(preset.seed)?;
            let (data, skip_bad) = (arguments.data.data.as_deref(), arguments.data.skip_bad);
            let plan = Plan::new(preset, &library, data, skip_bad, None)?;
            Begun::begin(folder, plan, library)?
        }
    };
    eprintln!("left out: {}", run.plan.split.held_out.join(", "));
    let stage = run.stage(&arguments.backend, arguments.resume, &interrupt);
    let mut peers = Peer::ALL.to_vec();
    peers.retain(|peer| arguments.only.is_empty() || arguments.only.contains(peer));
    stage.train_peers(&peers)?;
    for peer in peers {
        println!("{}", run.folder.file(&peer.model_file()).display());
    }
    Ok(())
}
