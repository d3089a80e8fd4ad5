//! Context of every step of a run.

use std::path::Path;
use std::sync::Arc;

use burn::module::Module as _;
use burn::tensor::Device;

use crate::optimization::fit::{CHECKPOINT_EVERY, Training};
use crate::student::model::Student;
use crate::teacher::model::Teacher;
use crate::weights::Weights as _;
use execution::fingerprint::Fingerprint;
use execution::interrupt::Interrupt;
use execution::run_folder::{RunError, RunFolder};
use presets::config::ResolvedConfig;
use presets::lineage;
use recordings::Library;

/// A run: its folder, its configuration, its recordings and the device that it computes on.
pub struct RunContext {
    /// The run folder.
    pub folder: RunFolder,
    /// The resolved configuration.
    pub config: ResolvedConfig,
    /// The recordings.
    pub library: Arc<Library>,
    /// The device, with gradients.
    pub device: Device,
    /// Whether to continue where an interrupted run stopped.
    pub resume: bool,
    /// The user's request to stop.
    pub interrupt: Interrupt,
}

impl RunContext {
    /// Begins a run: removes the checkpoints of an earlier one, which must not be continued, and writes the configuration
    /// into the folder. Models and results of an earlier run stay; they are refused if they do not belong to this one.
    pub fn begin(
        folder: RunFolder,
        config: ResolvedConfig,
        library: impl Into<Arc<Library>>,
        device: Device,
    ) -> Result<Self, RunError> {
        folder.remove_checkpoints()?;
        config.save(&folder)?;
        Ok(Self {
            folder,
            config,
            library: library.into(),
            device,
            resume: false,
            interrupt: Interrupt::default(),
        })
    }

    /// Continues the run in a folder.
    pub fn continue_run(
        folder: RunFolder,
        config: ResolvedConfig,
        library: impl Into<Arc<Library>>,
        device: Device,
    ) -> Result<Self, RunError> {
        let library = library.into();
        if lineage::recordings(&library, &config.split) != config.recordings {
            return Err(RunError::OtherRecordings {
                path: folder.path().to_owned(),
            });
        }
        Ok(Self {
            folder,
            config,
            library,
            device,
            resume: false,
            interrupt: Interrupt::default(),
        })
    }

    /// Finds the folder and the configuration of an earlier run.
    pub fn find(path: &Path) -> Result<(RunFolder, ResolvedConfig), RunError> {
        let folder = RunFolder::existing(path)?;
        let config = ResolvedConfig::load(&folder)?;
        Ok((folder, config))
    }

    /// Device without gradients.
    pub fn inference_device(&self) -> Device {
        self.device.clone().inner()
    }

    /// Whether the run folder holds weights of this name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.folder.weights_path(name).exists()
    }

    /// Loads the trained teacher, without gradients.
    pub(crate) fn teacher(&self) -> Result<Teacher, RunError> {
        load_teacher(&self.folder, &self.config, &self.inference_device())
    }

    /// Loads a trained student by the name of its files, without gradients.
    pub(crate) fn student(&self, name: &str) -> Result<Student, RunError> {
        load_student(&self.folder, &self.config, name, &self.inference_device())
    }

    /// Settings of a training whose weights depend on `made_from`, and on its own settings.
    pub fn training(&self, made_from: Fingerprint) -> Training<'_> {
        Training {
            run: &self.folder,
            made_from,
            resume: self.resume,
            checkpoint_every: CHECKPOINT_EVERY,
            interrupt: &self.interrupt,
        }
    }
}

/// Loads the trained teacher of a run folder, on a device without gradients.
pub fn load_teacher(
    folder: &RunFolder,
    config: &ResolvedConfig,
    device: &Device,
) -> Result<Teacher, RunError> {
    let preset = &config.preset;
    folder
        .load_model(
            presets::teacher::NAME,
            config.teacher_lineage(),
            Teacher::new(&preset.teacher, preset.classes, device),
        )
        .map(|model| model.valid())
}

/// Loads a trained student of a run folder by the name of its files, on a device without gradients.
pub fn load_student(
    folder: &RunFolder,
    config: &ResolvedConfig,
    name: &str,
    device: &Device,
) -> Result<Student, RunError> {
    let preset = &config.preset;
    let made_from = config.student_lineage(name, folder)?;
    folder
        .load_model(
            name,
            made_from,
            Student::new(&preset.student, preset.classes, preset.other(), device),
        )
        .map(|model| model.valid())
}
