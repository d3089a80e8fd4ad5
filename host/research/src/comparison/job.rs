//! One job of a study: one fold of one variant, from recordings to `results.json`.
//!
//! Jobs need nothing of each other but the pre-training that some variants start from, so that any
//! scheduler can run them in any number at once. A job that was interrupted goes on where it stopped.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::bail;
use burn::tensor::Device;

use myointent::dataset::Library;
use myointent::dataset::folds::Protocol;
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::{RunError, RunFolder, weights_file};
use myointent::run::config::{CONFIG, ResolvedConfig};
use myointent::run::context::RunContext;
use myointent::run::distill::{distill, train_on_labels};
use myointent::run::evaluate::{RESULTS, evaluate};
use myointent::run::preset::Preset;
use myointent::run::quantize::{MODEL, quantize};
use myointent::run::resolve::FoldChoice;
use myointent::run::train::train;
use myointent::teacher;

use super::variant::Variant;
use crate::baselines::{self, Baseline, BaselineSettings};

/// What all jobs of a study have in common.
pub struct Study<'a> {
    /// Folder of the study; a run lies in `VARIANT/fold-K`.
    pub folder: &'a Path,
    /// What the variants vary.
    pub preset: &'a Preset,
    /// How everybody is left out in turn.
    pub protocol: Protocol,
    /// The recordings.
    pub library: Arc<Library>,
    /// How baselines are trained.
    pub baselines: &'a BaselineSettings,
    /// Where the recordings lie.
    pub data: Option<&'a Path>,
    /// Whether damaged files were left out.
    pub strict: bool,
    /// What is computed on, with gradients.
    pub device: Device,
    /// Ctrl-C.
    pub interrupt: &'a Interrupt,
}

impl Study<'_> {
    /// The folds of a variant, from 1 on; none for a run without.
    ///
    /// # Errors
    /// When no recording has labels of the variant's classes.
    pub fn folds(&self, variant: Variant) -> anyhow::Result<Vec<Option<usize>>> {
        if !variant.has_folds() {
            return Ok(vec![None]);
        }
        let labelled = ResolvedConfig::labelled(&variant.preset(self.preset), &self.library)?;
        Ok((1..=self.protocol.folds(labelled)).map(Some).collect())
    }

    /// Runs a job, or what is left of it; nothing if its results are there.
    ///
    /// # Errors
    /// When a step fails, the pre-training is missing, or the folder holds another preset's run.
    pub fn run(&self, variant: Variant, fold: Option<usize>) -> anyhow::Result<()> {
        let path = self.path(variant, fold);
        let folder = RunFolder::open(&path)?;
        if folder.file(RESULTS).exists() {
            progress::log(&format!("{}: done before", path.display()));
            return Ok(());
        }
        let config = self.config(variant, fold, &folder)?;
        progress::log(&format!(
            "{}: leaving out {}",
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
        if !variant.is_student() {
            train(&context)?;
        }
        if !variant.has_folds() {
            return Ok(());
        }
        let model = if variant.has_students() || variant.is_student() {
            distill(&context)?;
            if variant.has_students() {
                train_on_labels(&context)?;
                baselines::training::train_all(&context, &Baseline::ALL, self.baselines)?;
            }
            Some(quantize(&context, &context.folder.file(MODEL))?)
        } else {
            None
        };
        evaluate(&context, model.as_deref(), &|trials| {
            Ok(baselines::inference::candidates(&context, trials)?)
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

    /// The config that the folder was begun with, or a new one.
    fn config(
        &self,
        variant: Variant,
        fold: Option<usize>,
        folder: &RunFolder,
    ) -> anyhow::Result<ResolvedConfig> {
        let choice = fold.map(|number| FoldChoice {
            protocol: self.protocol,
            number,
        });
        let preset = variant.preset(self.preset);
        let mut config =
            ResolvedConfig::new(preset, &self.library, self.data, self.strict, choice)?;
        config.variant = variant.to_string();
        if variant.is_pretrained() {
            let start = self.path(Variant::Pretraining, None);
            if !start.join(weights_file(teacher::training::NAME)).exists() {
                bail!(
                    "{}: no teacher to start from; run `myointent-research study --variant pretraining` first",
                    start.display()
                );
            }
            config.start_from(&start)?;
        }
        match ResolvedConfig::load(folder) {
            Ok(begun) if begun.preset != config.preset || begun.split != config.split => bail!(
                "{}: begun with another preset, protocol or recordings; give another --study folder",
                folder.file(CONFIG).display()
            ),
            Ok(begun) => Ok(begun),
            Err(RunError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                config.save(folder)?;
                Ok(config)
            }
            Err(error) => Err(error.into()),
        }
    }
}
