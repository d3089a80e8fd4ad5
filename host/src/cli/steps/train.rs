//! `myointent train`: the models that a preset asks for.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::{TrainingArguments, log_labels};
use execution::progress;
use presets::config::ResolvedConfig;
use presets::resolve::FoldChoice;
use presets::{distillation, teacher};
use recordings::Library;
use recordings::folds::Protocol;
use training::run::start::start_from;
use training::run::train::{train, train_teacher};

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent train --preset cpu --data recordings --run runs/mine\n  myointent train --run runs/mine --resume",
    after_long_help = "Examples:\n  myointent train --preset cpu --data recordings --run runs/mine\n  \
    myointent train --run runs/mine --resume\n  myointent presets cpu > mine.toml   # edit, then --preset mine.toml\n  \
    myointent train --preset cpu --data recordings --protocol loso --fold 1 --run runs/loso/fold-1\n  \
    myointent train --preset mine.toml --data mine --from runs/loso/fold-1 --run runs/tuned"
)]
pub struct Arguments {
    /// Built-in preset (quickstart, cpu, paper) or a TOML file; cpu if not given.
    #[arg(long)]
    preset: Option<String>,
    /// Run folder to write checkpoints and metrics to.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Train the teacher alone; `--resume` trains the student later.
    #[arg(hide_short_help = true, long)]
    teacher_only: bool,
    /// Fine-tune the teacher of this run, or a checkpoint of the reference (.pth, .safetensors), with the
    /// preset's fine-tuning settings.
    #[arg(hide_short_help = true, long, value_name = "RUN|FILE")]
    from: Option<PathBuf>,
    /// Train low-rank adapters alone (LoRA); needs --from.
    #[arg(hide_short_help = true, long, requires = "from")]
    lora: bool,
    /// Cross-validation: `loso` holds out one subject of each data set, `4-fold` (or any number) a fourth of them; needs
    /// --fold.
    ///
    /// Without it, the preset's lists and shares and host/recordings/people.toml decide.
    #[arg(hide_short_help = true, long, requires = "fold")]
    protocol: Option<Protocol>,
    /// Fold of the cross-validation, from 1 on; needs --protocol.
    ///
    /// Folds are independent.
    #[arg(hide_short_help = true, long, requires = "protocol")]
    fold: Option<usize>,
    #[command(flatten)]
    training: TrainingArguments,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let is_given =
        arguments.preset.is_some() || arguments.from.is_some() || arguments.protocol.is_some();
    let training = &arguments.training;
    let context = training.open(&arguments.run, is_given, || resolve(arguments))?;
    progress::log(&format!(
        "held out: {}",
        context.config.split.held_out.join(", ")
    ));
    log_labels(&context.config);
    let name = if arguments.teacher_only {
        train_teacher(&context)?;
        teacher::NAME
    } else {
        train(&context, training.teacher)?;
        distillation::NAME
    };
    let weights = context.folder.weights_path(name);
    writeln!(std::io::stdout(), "{}", weights.display())?;
    Ok(())
}

/// Resolves the configuration that the options give, and loads the recordings.
fn resolve(arguments: &Arguments) -> anyhow::Result<(ResolvedConfig, Library)> {
    let name = arguments.preset.as_deref().unwrap_or("cpu");
    let (mut preset, library) = arguments.training.preset(name)?;
    let data = &arguments.training.data;
    if arguments.from.is_some() {
        preset = preset.fine_tuned(arguments.lora);
    }
    let fold = arguments.protocol.zip(arguments.fold);
    let mut config = ResolvedConfig::new(
        preset,
        &library,
        data.folder().as_deref(),
        data.strict,
        fold.map(|(protocol, number)| FoldChoice { protocol, number }),
    )?;
    if let Some(start) = &arguments.from {
        start_from(&mut config, start)?;
    }
    Ok((config, library))
}
