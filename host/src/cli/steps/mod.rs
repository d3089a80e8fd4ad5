//! Commands that need the training feature: the steps of a run, all of them at once, and tuning.

pub(super) mod evaluate;
mod export;
mod personalize;
mod quantize;
mod quickstart;
mod train;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ::presets::Preset;
use ::presets::config::ResolvedConfig;
use anyhow::Context as _;
use clap::{Args, Subcommand};
use evaluation::report::labels;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunFolder;
use recordings::{Library, LoadError, LoadOptions, Recording, load, synthetic};
use training::backend::BackendArguments;
use training::run::StepError;
use training::run::context::RunContext;
use training::run::personalize::PersonalizeError;

use super::arguments::{log_found, refused};

/// Commands of a program that trains.
#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Train, quantize and evaluate in one command, in a few minutes on two cores.
    Quickstart(quickstart::Arguments),
    /// Train what the preset asks for: the student, and first the teacher or the ensemble that it learns from.
    Train(train::Arguments),
    /// Quantize the student and write the model file.
    Quantize(quantize::Arguments),
    /// Write the teacher's weights as safetensors, with the names of ReactEMG's code, or the float student as ONNX; the
    /// model file for a board is written by `quantize`.
    Export(export::Arguments),
    /// Tune a model file on one person's own recordings, and keep it only if it is not worse.
    Personalize(personalize::Arguments),
}

impl Command {
    pub(super) fn run(&self) -> anyhow::Result<()> {
        match self {
            Self::Quickstart(arguments) => quickstart::run(arguments),
            Self::Train(arguments) => train::run(arguments),
            Self::Quantize(arguments) => quantize::run(arguments),
            Self::Export(arguments) => export::run(arguments),
            Self::Personalize(arguments) => personalize::run(arguments),
        }
    }

    /// Whether `--resume` continues the command after an interrupt.
    pub(super) const fn resumes(&self) -> bool {
        matches!(self, Self::Quickstart(_) | Self::Train(_))
    }
}

/// Whether `personalize` refuses to tune the old model.
pub(super) fn keeps_the_old(error: &anyhow::Error) -> bool {
    let refused = error.downcast_ref::<PersonalizeError>();
    refused.is_some_and(PersonalizeError::keeps_the_old)
}

/// Whether the user interrupted a step.
pub(super) fn is_interrupt(cause: &(dyn std::error::Error + 'static)) -> bool {
    let personalize = cause.downcast_ref();
    cause.downcast_ref().is_some_and(StepError::is_interrupt)
        || personalize.is_some_and(PersonalizeError::is_interrupt)
}

/// Recordings to read.
#[derive(Clone, Debug, Args)]
pub struct DataArguments {
    /// Folder of recordings, of one data set or of several.
    ///
    /// If not given: the folder that the variable MYOINTENT_DATA names, or else ./data, or else ../shared/data; without any
    /// of them, synthetic recordings.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Refuse damaged files instead of leaving them out.
    #[arg(long)]
    pub strict: bool,
}

/// Environment variable with the folder of recordings; empty counts as unset.
const VARIABLE: &str = "MYOINTENT_DATA";
/// Folders that are searched if none is named.
const DEFAULT_FOLDERS: [&str; 2] = ["data", "../shared/data"];

impl DataArguments {
    /// Folder of the recordings; none for synthetic ones.
    pub fn folder(&self) -> Option<PathBuf> {
        let variable = || std::env::var_os(VARIABLE).filter(|value| !value.is_empty());
        let default = || {
            let mut folders = DEFAULT_FOLDERS.iter().map(PathBuf::from);
            folders.find(|folder| folder.is_dir())
        };
        self.data
            .clone()
            .or_else(|| variable().map(PathBuf::from))
            .or_else(default)
    }

    /// Loads the recordings, or generates synthetic ones; logs which.
    pub fn load(&self, preset: &Preset) -> anyhow::Result<Library> {
        recordings(self.folder().as_deref(), self.strict, preset)
    }
}

/// Options of the commands that train.
#[derive(Debug, Args)]
struct TrainingArguments {
    /// Train the teacher even if the preset's student does not learn from it.
    #[arg(hide_short_help = true, long)]
    teacher: bool,
    /// Seed of all random numbers, instead of the preset's, which is 42 in the built-in presets.
    #[arg(long)]
    seed: Option<u64>,
    /// Continue after the last checkpoint of this run folder.
    ///
    /// Options that decide the outcome may be left out; if given, they must be those that the run began with.
    #[arg(long)]
    resume: bool,
    /// Begin anew in a run folder that holds a run, in its place.
    ///
    /// Without it, such a folder is refused.
    #[arg(long, conflicts_with = "resume")]
    overwrite: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

impl TrainingArguments {
    /// Finds a preset, sets its seed, and loads its recordings.
    fn preset(&self, name: &str) -> anyhow::Result<(Preset, Library)> {
        let mut preset = Preset::find(name)?;
        preset.seed = self.seed.unwrap_or(preset.seed);
        let library = self.data.load(&preset)?;
        Ok((preset, library))
    }

    /// Begins the run that `resolve` describes, or opens the one to continue. With `is_given`, or the options here that decide
    /// the outcome, a run to continue must be the same.
    fn open(
        &self,
        run: &Path,
        is_given: bool,
        resolve: impl FnOnce() -> anyhow::Result<(ResolvedConfig, Library)>,
    ) -> anyhow::Result<RunContext> {
        if self.resume {
            let is_given = is_given || self.seed.is_some() || self.data.strict;
            let repeated = is_given.then(resolve).transpose()?;
            return resume_run(run, self.backend, &self.data, repeated);
        }
        if !self.overwrite {
            RunFolder::refuse_run(run)?;
        }
        let device = self.backend.device()?;
        let (config, library) = resolve()?;
        let folder = RunFolder::open(run)?;
        Ok(RunContext {
            interrupt: Interrupt::listen(),
            ..RunContext::begin(folder, config, library, device)?
        })
    }
}

/// Opens the run in a folder for writing, with the recordings that it was started with.
pub fn open_run(path: &Path, backend: BackendArguments) -> anyhow::Result<RunContext> {
    let (folder, config) = lock_run(path)?;
    let device = backend.device()?;
    let library = recordings(config.data.as_deref(), config.strict, &config.preset)?;
    Ok(RunContext {
        interrupt: Interrupt::listen(),
        ..RunContext::continue_run(folder, config, library, device)?
    })
}

/// Locks the run in a folder against other writers.
fn lock_run(path: &Path) -> anyhow::Result<(RunFolder, ResolvedConfig)> {
    let folder = find_run(path)?.0.locked()?;
    // Read again under the lock: the run may have been replaced.
    let config = ResolvedConfig::load(&folder)?;
    Ok((folder, config))
}

/// Finds the folder and the configuration of an earlier run, for reading.
pub(crate) fn find_run(path: &Path) -> anyhow::Result<(RunFolder, ResolvedConfig)> {
    RunContext::find(path).with_context(|| {
        let run = path.display();
        format!("{run} is not a run folder; start with `myointent train --run {run}`")
    })
}

/// Opens the run that an interrupted command is to continue.
///
/// Options that decide the outcome are those of the run. If the command repeats them, they must give the same
/// configuration.
pub(crate) fn resume_run(
    path: &Path,
    backend: BackendArguments,
    data: &DataArguments,
    repeated: Option<(ResolvedConfig, Library)>,
) -> anyhow::Result<RunContext> {
    let (folder, config) = lock_run(path)?;
    let device = backend.device()?;
    let library = match repeated {
        Some((repeated, library)) => {
            config.must_equal(&repeated, &folder)?;
            library
        }
        None => {
            let moved = data.data.as_deref().or(config.data.as_deref());
            recordings(moved, config.strict, &config.preset)?
        }
    };
    Ok(RunContext {
        resume: true,
        interrupt: Interrupt::listen(),
        ..RunContext::continue_run(folder, config, library, device)?
    })
}

/// Loads the recordings below a path: of the preset's data sets, or of all sets if none of these is found. Without a path,
/// generates synthetic ones.
pub(crate) fn recordings(
    data: Option<&Path>,
    strict: bool,
    preset: &Preset,
) -> anyhow::Result<Library> {
    let Some(path) = data else {
        progress::log(
            "no --data DIR: generating synthetic recordings, which show that the code works, and nothing about people",
        );
        return Ok(Library {
            recordings: synthetic::generate(&synthetic::SynthOptions {
                seed: preset.seed,
                ..Default::default()
            }),
            ..Library::default()
        });
    };
    // The preset says whether its electrodes are aligned.
    let mut options = LoadOptions {
        strict,
        data_sets: preset.data.data_sets.clone(),
        as_recorded: true,
    };
    let library = match load(path, &options) {
        Err(LoadError::NoRecordings { .. }) if !options.data_sets.is_empty() => {
            progress::log(&format!(
                "none of the preset's data sets is in {}: using all recordings",
                path.display()
            ));
            options.data_sets.clear();
            load(path, &options)
        }
        library => library,
    }
    .map_err(refused)?;
    library.not_empty(path)?;
    if preset.data.align_electrodes {
        let frames = library.frames();
        frames.iter().for_each(|frame| progress::log(frame));
    }
    log_found(&library, &path.display().to_string());
    if preset.data.daily_life > 0.0 && !library.recordings.iter().any(Recording::is_daily_life) {
        progress::log(
            "no daily life found: a model that has not learned from it raises labels when nothing is meant (docs/recordings.md#daily-life)",
        );
    }
    Ok(library)
}

/// Logs how the labels of each data set are compensated for their lag.
pub(crate) fn log_labels(config: &ResolvedConfig) {
    for (what, how) in labels(&config.lags, &BTreeMap::new()) {
        progress::log(&format!("{what}: {how}"));
    }
}
