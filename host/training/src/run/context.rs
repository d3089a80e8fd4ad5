//! Context of every step of a run.

use std::path::Path;
use std::sync::Arc;

use burn::module::Module as _;
use burn::tensor::Device;
use shared::model::LookBackLogits;
use shared::units::CleanSample;

use crate::inference::{student_logits, teacher_logits};
use crate::optimization::REPLACED;
use crate::optimization::fit::{CHECKPOINT_EVERY, Training};
use crate::student::model::Student;
use crate::teacher::model::Teacher;
use crate::weights::load_model;
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
        Ok(Self::new(folder, config, library.into(), device))
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
        Ok(Self::new(folder, config, library, device))
    }

    fn new(
        folder: RunFolder,
        config: ResolvedConfig,
        library: Arc<Library>,
        device: Device,
    ) -> Self {
        Self {
            folder,
            config,
            library,
            device,
            resume: false,
            interrupt: Interrupt::default(),
        }
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

    /// Loads a float model by the name of its files.
    pub(crate) fn logits(&self, name: &str) -> Result<FloatModel, RunError> {
        let device = self.inference_device();
        if name == presets::teacher::NAME {
            let model = load_teacher(&self.folder, &self.config, &device)?;
            let shape = self.config.preset.teacher.window_shape();
            return Ok(Box::new(move |emg| {
                teacher_logits(&model, shape, emg, &device)
            }));
        }
        let model = self.student(name)?;
        Ok(Box::new(move |emg| student_logits(&model, emg, &device)))
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

/// Float model of a run: its logits at every patch of a stream.
pub type FloatModel = Box<dyn Fn(&[CleanSample]) -> Vec<LookBackLogits> + Send + Sync>;

/// Loads the trained teacher of a run folder, on a device without gradients.
pub fn load_teacher(
    folder: &RunFolder,
    config: &ResolvedConfig,
    device: &Device,
) -> Result<Teacher, RunError> {
    let preset = &config.preset;
    let (name, made_from) = (presets::teacher::NAME, config.teacher_lineage());
    let teacher = Teacher::new(REPLACED, &preset.teacher, preset.classes, device);
    Ok(load_model(folder, name, made_from, teacher)?.valid())
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
    let other = preset.other();
    let student = Student::new(REPLACED, &preset.student, preset.classes, other, device);
    Ok(load_model(folder, name, made_from, student)?.valid())
}
