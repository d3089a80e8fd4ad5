//! Arguments that several subcommands share.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use burn::tensor::Device;
use clap::{Args, ValueEnum};

use crate::execution::interrupt::Interrupt;
use crate::run::plan::Plan;
use crate::dataset::Library;
use crate::dataset::LoadOptions;
use crate::dataset::load;
use crate::dataset::synthetic;
use crate::execution::run_folder::{RunError, RunFolder};
use crate::run::stage::Stage;

/// Where recordings lie.
#[derive(Clone, Debug, Args)]
pub struct DataArguments {
    /// Folder of recordings, of one data set or of several; `MYOINTENT_DATA` if not given.
    #[arg(long, value_name = "DIR", env = "MYOINTENT_DATA")]
    pub data: Option<PathBuf>,
    /// Leave damaged files out, and say which, rather than stop at the first.
    #[arg(long)]
    pub skip_bad: bool,
}

/// What tensors are computed on.
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
    /// What to compute on; the fastest that is compiled in if not given.
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
    /// Loads the recordings, or makes synthetic ones where none are given; says which.
    ///
    /// # Errors
    /// When a file is damaged and damaged files are not to be left out.
    pub fn load(&self, seed: u64) -> anyhow::Result<Library> {
        recordings(self.data.as_deref(), self.skip_bad, seed)
    }
}

/// A run that has a plan, with the recordings that it is about.
pub struct Begun {
    /// Where everything is written.
    pub folder: RunFolder,
    /// What will run.
    pub plan: Plan,
    /// The recordings.
    pub library: Library,
}

impl Begun {
    /// The run in a folder, with the recordings that it was begun with.
    ///
    /// # Errors
    /// When the folder holds no plan or the recordings cannot be read.
    pub fn open(run: &Path) -> anyhow::Result<Self> {
        let (folder, plan) = RunFolder::existing(run)
            .and_then(|folder| Plan::load(&folder).map(|plan| (folder, plan)))
            .with_context(|| {
                let run = run.display();
                format!("no run has begun in {run}; start with `myointent train --run {run}`")
            })?;
        let library = recordings(plan.data.as_deref(), plan.skip_bad, plan.preset.seed)?;
        Ok(Self {
            folder,
            plan,
            library,
        })
    }

    /// A run that begins, or goes on, by this plan: it is written into the folder.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn begin(folder: RunFolder, plan: Plan, library: Library) -> Result<Self, RunError> {
        plan.save(&folder)?;
        Ok(Self {
            folder,
            plan,
            library,
        })
    }

    /// The run's steps.
    #[must_use]
    pub fn stage<'a>(
        &'a self,
        backend: &BackendArguments,
        resume: bool,
        interrupt: &'a Interrupt,
    ) -> Stage<'a> {
        Stage {
            run: &self.folder,
            plan: &self.plan,
            library: &self.library,
            device: backend.device(),
            resume,
            interrupt,
        }
    }
}

/// Recordings below a path, or synthetic ones.
///
/// # Errors
/// When a file is damaged and damaged files are not to be left out.
pub fn recordings(data: Option<&Path>, skip_bad: bool, seed: u64) -> anyhow::Result<Library> {
    let Some(path) = data else {
        eprintln!("no recordings given: making synthetic ones (give real ones with --data DIR)");
        return Ok(Library {
            recordings: synthetic::generate(&synthetic::SynthOptions {
                seed,
                ..Default::default()
            }),
            ..Library::default()
        });
    };
    let library = load(path, &LoadOptions { skip_bad })
        .context("damaged recordings can be left out with --skip-bad")?;
    for skipped in &library.skipped {
        eprintln!("left out: {}", skipped.error);
    }
    eprintln!(
        "{} recordings in {}",
        library.recordings.len(),
        path.display()
    );
    Ok(library)
}
