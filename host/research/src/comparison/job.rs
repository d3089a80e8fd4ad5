//! One job of a study: one fold of one variant, from recordings to `results.json`.
//!
//! Jobs need nothing of each other but the pre-training that some variants start from, so that any
//! scheduler can run them in any number at once. A job that was interrupted goes on where it stopped.

use std::path::{Path, PathBuf};

use anyhow::bail;
use burn::tensor::Device;

use super::variant::Variant;
use myointent::execution::interrupt::Interrupt;
use crate::baselines::Peer;
use myointent::run::plan::{Plan, Turn};
use myointent::run::preset::Preset;
use myointent::execution::progress;
use myointent::dataset::Library;
use myointent::dataset::folds::Protocol;
use myointent::execution::run_folder::{RunError, RunFolder, model_file};
use myointent::run::stage::{RESULTS, Stage};
use myointent::teacher;

/// What all jobs of a study have in common.
pub struct Study<'a> {
    /// Folder of the study; a run lies in `VARIANT/fold-K`.
    pub folder: &'a Path,
    /// What the variants vary.
    pub preset: &'a Preset,
    /// How everybody is left out in turn.
    pub protocol: Protocol,
    /// The recordings.
    pub library: &'a Library,
    /// Where they lie.
    pub data: Option<&'a Path>,
    /// Whether damaged files were left out.
    pub skip_bad: bool,
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
        let labelled = Plan::labelled(&variant.preset(self.preset), self.library)?;
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
            progress::say(&format!("{}: done before", path.display()));
            return Ok(());
        }
        let plan = self.plan(variant, fold, &folder)?;
        progress::say(&format!(
            "{}: leaving out {}",
            path.display(),
            plan.split.held_out.join(", ")
        ));
        let stage = Stage {
            run: &folder,
            plan: &plan,
            library: self.library,
            device: self.device.clone(),
            resume: true,
            interrupt: self.interrupt,
        };
        if !variant.is_student() {
            stage.train()?;
        }
        if !variant.has_folds() {
            return Ok(());
        }
        let model = if variant.has_students() || variant.is_student() {
            stage.distill()?;
            if variant.has_students() {
                stage.train_alone()?;
                stage.train_peers(&Peer::ALL)?;
            }
            Some(stage.quantize(&folder.file(myointent::cli::quickstart::MODEL))?)
        } else {
            None
        };
        stage.evaluate(model.as_deref())?;
        Ok(())
    }

    fn path(&self, variant: Variant, fold: Option<usize>) -> PathBuf {
        let path = self.folder.join(variant.to_string());
        match fold {
            Some(number) => path.join(format!("fold-{number}")),
            None => path,
        }
    }

    /// The plan that the folder was begun with, or a new one.
    fn plan(
        &self,
        variant: Variant,
        fold: Option<usize>,
        folder: &RunFolder,
    ) -> anyhow::Result<Plan> {
        let turn = fold.map(|number| Turn {
            protocol: self.protocol,
            number,
        });
        let preset = variant.preset(self.preset);
        let mut plan = Plan::new(preset, self.library, self.data, self.skip_bad, turn)?;
        plan.variant = variant.to_string();
        if variant.is_pretrained() {
            let start = self.path(Variant::Pretraining, None);
            if !start.join(model_file(teacher::training::NAME)).exists() {
                bail!(
                    "{}: no teacher to start from; run `myointent study --variant pretraining` first",
                    start.display()
                );
            }
            plan.start_from(&start)?;
        }
        match Plan::load(folder) {
            Ok(begun) if begun.preset != plan.preset || begun.split != plan.split => bail!(
                "{}: begun with another preset, protocol or recordings; give another --study folder",
                folder.file("plan.json").display()
            ),
            Ok(begun) => Ok(begun),
            Err(RunError::Io { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                plan.save(folder)?;
                Ok(plan)
            }
            Err(error) => Err(error.into()),
        }
    }
}
