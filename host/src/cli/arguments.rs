//! Arguments that several subcommands share.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use burn::tensor::Device;
use clap::{Args, ValueEnum};

use crate::dataset::{Library, LoadError, LoadOptions, load, synthetic};
use crate::execution::interrupt::Interrupt;
use crate::execution::progress;
use crate::run::context::RunContext;
use crate::run::preset::Preset;

/// Which recordings to read.
#[derive(Clone, Debug, Args)]
pub struct DataArguments {
    /// Folder of recordings, of one data set or of several; `MYOINTENT_DATA` if not given.
    #[arg(long, value_name = "DIR", env = "MYOINTENT_DATA")]
    pub data: Option<PathBuf>,
    /// Refuse damaged files instead of leaving them out.
    #[arg(long)]
    pub strict: bool,
}

/// Library that computes on tensors.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Backend {
    /// Burn's newer CPU backend.
    #[cfg(feature = "flex")]
    Flex,
    /// Burn's CPU backend on the ndarray crate.
    #[cfg(feature = "ndarray")]
    Ndarray,
    /// An NVIDIA GPU.
    #[cfg(feature = "cuda")]
    Cuda,
    /// Any GPU, through wgpu.
    #[cfg(feature = "wgpu")]
    Wgpu,
}

/// Choice of a backend among those compiled in.
#[derive(Clone, Copy, Debug, Args)]
pub struct BackendArguments {
    /// Library that computes on tensors; the fastest that is compiled in if not given.
    #[arg(long, value_enum)]
    pub backend: Option<Backend>,
}

impl BackendArguments {
    /// The device, with gradients.
    #[must_use]
    pub fn device(self) -> Device {
        let plain = match self.backend {
            None => Device::default(),
            #[cfg(feature = "flex")]
            Some(Backend::Flex) => Device::flex(),
            #[cfg(feature = "ndarray")]
            Some(Backend::Ndarray) => ndarray(),
            #[cfg(feature = "cuda")]
            Some(Backend::Cuda) => Device::cuda(0),
            #[cfg(feature = "wgpu")]
            Some(Backend::Wgpu) => Device::wgpu(burn::tensor::DeviceKind::DefaultDevice),
        };
        plain.autodiff()
    }
}

/// Burn 0.22 deprecates this backend in favour of `flex`; it stays selectable while it is there.
#[cfg(feature = "ndarray")]
#[expect(deprecated, reason = "selectable on purpose, see docs/decisions.md")]
fn ndarray() -> Device {
    Device::ndarray()
}

impl DataArguments {
    /// Loads the recordings, or generates synthetic ones without `--data`; logs which.
    ///
    /// # Errors
    /// When nothing can be read, or a file is damaged and `--strict` is given.
    pub fn load(&self, preset: &Preset) -> anyhow::Result<Library> {
        recordings(self.data.as_deref(), self.strict, preset)
    }
}

/// The run in a folder, with the recordings that it was started with.
///
/// # Errors
/// When the folder holds no run or the recordings cannot be read.
pub fn open_run(path: &Path, backend: BackendArguments) -> anyhow::Result<RunContext> {
    let (folder, config) = RunContext::find(path).with_context(|| {
        let run = path.display();
        format!("{run} is not a run folder; start with `myointent train --run {run}`")
    })?;
    let library = recordings(config.data.as_deref(), config.strict, &config.preset)?;
    Ok(RunContext {
        folder,
        config,
        library: library.into(),
        device: backend.device(),
        resume: false,
        interrupt: Interrupt::listen(),
    })
}

/// Recordings below a path, of the preset's data sets, or of all if none of these is found; synthetic
/// ones without a path.
///
/// # Errors
/// When nothing can be read, or a file is damaged and `strict`.
pub(crate) fn recordings(
    data: Option<&Path>,
    strict: bool,
    preset: &Preset,
) -> anyhow::Result<Library> {
    let Some(path) = data else {
        progress::log(
            "no --data DIR: generating synthetic recordings, which show that the code works and no more",
        );
        return Ok(Library {
            recordings: synthetic::generate(&synthetic::SynthOptions {
                seed: preset.seed,
                ..Default::default()
            }),
            ..Library::default()
        });
    };
    let options = LoadOptions {
        strict,
        data_sets: preset.data.data_sets.clone(),
    };
    let library = match load(path, &options) {
        Err(LoadError::NoRecordings { .. }) if !options.data_sets.is_empty() => {
            progress::log(&format!(
                "none of the preset's data sets is in {}: using all recordings",
                path.display()
            ));
            let data_sets = Vec::new();
            load(path, &LoadOptions { strict, data_sets })
        }
        library => library,
    }
    .map_err(refused)?;
    if let Some(first) = library.skipped.first() {
        progress::log(&format!(
            "damaged files left out: {} (`myointent data inspect` lists them); the first: {first}",
            library.skipped.len()
        ));
    }
    progress::log(&format!(
        "{} recordings in {}",
        library.recordings.len(),
        path.display()
    ));
    Ok(library)
}

/// What stops a load, with the option that leaves damaged files out.
pub(crate) fn refused(error: LoadError) -> anyhow::Error {
    match error {
        LoadError::Damaged { .. } => anyhow::Error::new(error)
            .context("--strict refuses this file; without it, damaged files are left out"),
        other => other.into(),
    }
}
