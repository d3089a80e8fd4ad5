//! `myointent train`: the teacher.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{BackendArguments, Begun, DataArguments};
use crate::execution::interrupt::Interrupt;
use crate::run::plan::{Plan, Turn};
use crate::run::preset::Preset;
use crate::dataset::folds::Protocol;
use crate::execution::run_folder::RunFolder;
use crate::teacher;

/// Arguments of `train`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent train --preset cpu --data recordings --run runs/mine\n  \
    myointent train --run runs/mine --resume\n  myointent presets cpu > mine.toml   # edit, then --preset mine.toml\n  \
    myointent train --preset cpu --data recordings --protocol loso --fold 1 --run runs/loso/fold-1\n  \
    myointent train --preset mine.toml --data mine --from runs/loso/fold-1 --run runs/tuned"
)]
pub struct Arguments {
    /// Built-in preset (quickstart, cpu, paper) or a TOML file.
    #[arg(long, default_value = "cpu")]
    preset: String,
    /// Folder for checkpoints, metrics and everything that follows.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Start from what this run's teacher has learnt, or from a checkpoint of the reference (.pth,
    /// .safetensors), at the preset's pace of fine-tuning.
    #[arg(long, value_name = "RUN|FILE", conflicts_with = "resume")]
    from: Option<PathBuf>,
    /// Train low-rank additions alone (LoRA).
    #[arg(long, requires = "from")]
    lora: bool,
    /// Who is left out: `loso` leaves one subject of each data set out, `4-fold` (or any number) a
    /// fourth of them; the preset's lists if not given.
    #[arg(long, requires = "fold", conflicts_with = "resume")]
    protocol: Option<Protocol>,
    /// Which of the protocol's runs, from 1 on; each stands for itself.
    #[arg(long, requires = "protocol")]
    fold: Option<usize>,
    /// Seed of everything drawn, instead of the preset's.
    #[arg(long)]
    seed: Option<u64>,
    /// Go on after the last complete epoch of this run folder.
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Trains the teacher.
///
/// # Errors
/// When recordings, preset or folder cannot be used.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let run = if arguments.resume {
        Begun::open(&arguments.run)?
    } else {
        let mut preset = Preset::find(&arguments.preset)?;
        preset.seed = arguments.seed.unwrap_or(preset.seed);
        let library = arguments.data.load(preset.seed)?;
        if arguments.from.is_some() {
            preset = preset.fine_tuned(arguments.lora);
        }
        let turn = arguments.protocol.zip(arguments.fold);
        let mut plan = Plan::new(
            preset,
            &library,
            arguments.data.data.as_deref(),
            arguments.data.skip_bad,
            turn.map(|(protocol, number)| Turn { protocol, number }),
        )?;
        if let Some(start) = &arguments.from {
            plan.start_from(start)?;
        }
        let folder = RunFolder::open(&arguments.run)?;
        Begun::begin(folder, plan, library)?
    };
    eprintln!("left out: {}", run.plan.split.held_out.join(", "));
    let stage = run.stage(&arguments.backend, arguments.resume, &interrupt);
    stage.train()?;
    println!("{}", run.folder.model(teacher::training::NAME).display());
    Ok(())
}
