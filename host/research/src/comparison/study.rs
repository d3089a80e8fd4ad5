//! The jobs of a study. A job is one fold of one variant, from recordings to `results.json`.
//!
//! Jobs are independent, except that some variants start from the pre-trained teacher, so a scheduler may
//! run them in parallel. An interrupted job continues where it stopped.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use burn::tensor::Device;

use myointent::dataset::Library;
use myointent::dataset::folds::Protocol;
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::{RunFolder, weights_file};
use myointent::run::config::ResolvedConfig;
use myointent::run::context::RunContext;
use myointent::run::distill::{distill, train_on_labels};
use myointent::run::evaluate::{RESULTS, Results, evaluate};
use myointent::run::preset::Preset;
use myointent::run::quantize::{MODEL, ModelFile, quantize};
use myointent::run::resolve::{ConfigError, FoldChoice};
use myointent::run::train::train;
use myointent::teacher;

use super::variant::Variant;
use crate::baselines::Baseline;
use crate::baselines::inference::candidates;
use crate::baselines::settings::BaselineSettings;
use crate::baselines::training::train_all;
use crate::job::{JobError, begun};

/// What all jobs of a study have in common.
pub(crate) struct Study<'a> {
    /// Folder of the study; run folders are `VARIANT/fold-K` in it.
    pub(crate) folder: &'a Path,
    /// The preset that the variants modify.
    pub(crate) preset: &'a Preset,
    /// How subjects are divided into folds.
    pub(crate) protocol: Protocol,
    /// The recordings.
    pub(crate) library: Arc<Library>,
    /// How baselines are trained.
    pub(crate) baselines: &'a BaselineSettings,
    /// Folder of the recordings; none for synthetic ones.
    pub(crate) data: Option<&'a Path>,
    /// Whether damaged files were refused rather than left out.
    pub(crate) strict: bool,
    /// Device with gradients.
    pub(crate) device: Device,
    /// Set by Ctrl-C.
    pub(crate) interrupt: &'a Interrupt,
}

impl Study<'_> {
    /// The folds of a variant, 1 first; a single none for a variant without folds.
    ///
    /// # Errors
    /// When no recording has labels of the variant's classes.
    pub(crate) fn folds(&self, variant: Variant) -> Result<Vec<Option<usize>>, ConfigError> {
        if !variant.has_folds() {
            return Ok(vec![None]);
        }
        let labelled = ResolvedConfig::labelled(&variant.preset(self.preset), &self.library)?;
        Ok((1..=self.protocol.folds(labelled)).map(Some).collect())
    }

    /// Runs a job or the rest of it; does nothing if its results exist.
    ///
    /// # Errors
    /// When a step fails, the pre-training is missing, or the folder holds a run with other settings.
    pub(crate) fn run(&self, variant: Variant, fold: Option<usize>) -> Result<(), JobError> {
        let path = self.path(variant, fold);
        let folder = RunFolder::open(&path)?;
        let config = self.config(variant, fold, &folder)?;
        let made_from = config.fingerprint();
        if folder.load_stamped::<Results>(RESULTS, made_from).is_ok() {
            progress::log(&format!("{}: already evaluated", path.display()));
            return Ok(());
        }
        progress::log(&format!(
            "{}: held out: {}",
            path.display(),
            config.split.held_out.join(", ")
        ));
        let context = RunContext {
            folder,
            config,
            library: self.library.clone(),
            device: self.device.clone(),
            resume: true,
            interrupt: self.interrupt.clone(),
        };
        if variant.has_teacher() {
            train(&context)?;
        }
        if !variant.has_folds() {
            return Ok(());
        }
        let model = if variant.has_student() {
            distill(&context)?;
            if variant.has_baselines() {
                train_on_labels(&context)?;
                train_all(&context, &Baseline::ALL, self.baselines)?;
            }
            quantize(&context, &context.folder.file(MODEL))?;
            ModelFile::of_run(&context)?
        } else {
            None
        };
        evaluate(&context, model.as_ref(), &|trials| {
            Ok(candidates(&context, trials)?)
        })?;
        Ok(())
    }

    fn path(&self, variant: Variant, fold: Option<usize>) -> PathBuf {
        let path = self.folder.join(variant.to_string());
        match fold {
            Some(number) => path.join(format!("fold-{number}")),
            None => path,
        }
    }

    /// The configuration in the folder if the job was started before, or a new one.
    fn config(
        &self,
        variant: Variant,
        fold: Option<usize>,
        folder: &RunFolder,
    ) -> Result<ResolvedConfig, JobError> {
        let choice = fold.map(|number| FoldChoice {
            protocol: self.protocol,
            number,
        });
        let preset = variant.preset(self.preset);
        let mut config =
            ResolvedConfig::new(preset, &self.library, self.data, self.strict, choice)?;
        config.variant = variant.to_string();
        if variant.starts_from_pretraining() {
            let start = self.path(Variant::Pretraining, None);
            if !start.join(weights_file(teacher::training::NAME)).exists() {
                return Err(JobError::NoPretraining { path: start });
            }
            config.start_from(&start)?;
        }
        begun(folder, config)
    }
}
