//! `myointent train`: the teacher.

use std::path::PathBuf;

use clap::Args;

use super::arguments::{BackendArguments, DataArguments, begun};
use crate::interrupt::Interrupt;
use crate::plan::Plan;
use crate::preset::Preset;
use crate::run_folder::RunFolder;
use crate::stage::Stage;

/// Arguments of `train`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent train --preset cpu --data recordings --run runs/mine\n  \
    myointent train --run runs/mine --resume\n  myointent presets cpu > mine.toml   # edit, then --preset mine.toml"
)]
pub struct Arguments {
    /// Built-in preset (quickstart, cpu, paper) or a TOML file.
    #[arg(long, default_value = "cpu")]
    preset: String,
    /// Folder for checkpoints, metrics and everything that follows.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
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
    let (folder, plan, library) = if arguments.resume {
        begun(&arguments.run)?
    } else {
        let mut preset = Preset::find(&arguments.preset)?;
        preset.seed = arguments.seed.unwrap_or(preset.seed);
        let library = arguments.data.load(preset.seed)?;
        let plan = Plan::new(
            preset,
            &library,
            arguments.data.data.as_deref(),
            arguments.data.skip_bad,
        )?;
        let folder = RunFolder::open(&arguments.run)?;
        plan.save(&folder)?;
        (folder, plan, library)
    };
    eprintln!("left out: {}", plan.split.held_out.join(", "));
    let stage = Stage {
        run: &folder,
        plan: &plan,
        library: &library,
        device: arguments.backend.device(),
        resume: arguments.resume,
        interrupt: &interrupt,
    };
    stage.train()?;
    println!("{}", folder.file("teacher.bpk").display());
    Ok(())
}
