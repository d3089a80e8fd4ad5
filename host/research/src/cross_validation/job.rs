//! One job: a preset with one seed, trained for one fold and evaluated on its people.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use burn::tensor::Device;
use serde::{Deserialize, Serialize};

use myointent::dataset::Library;
use myointent::dataset::folds::Protocol;
use myointent::evaluation::{ALL, LookAhead, Score, Truth, score};
use myointent::execution::interrupt::Interrupt;
use myointent::execution::progress;
use myointent::execution::run_folder::RunFolder;
use myointent::run::StepError;
use myointent::run::config::ResolvedConfig;
use myointent::run::context::RunContext;
use myointent::run::distill::distill;
use myointent::run::model_evaluation::{NamedModel, Selection, evaluate_models};
use myointent::run::preset::{EntryMargins, Preset};
use myointent::run::quantize::{MODEL, quantize};
use myointent::run::resolve::{FoldChoice, fold_people};
use myointent::run::train::train;

use crate::job::{JobError, begun};

/// Name of a job's scores in its run folder.
const SCORES: &str = "cross-validation.json";

/// What all jobs have in common.
pub(crate) struct CrossValidation<'a> {
    /// Run folders are `PRESET/seed-S/fold-K` in it.
    pub(crate) folder: &'a Path,
    /// Number of folds.
    pub(crate) folds: usize,
    /// Confidence gates to evaluate with; none is that of the preset.
    pub(crate) entry_margins: Vec<Option<f32>>,
    /// The recordings.
    pub(crate) library: Arc<Library>,
    /// Folder of the recordings; none for synthetic ones.
    pub(crate) data: Option<&'a Path>,
    /// Whether damaged files were refused rather than left out.
    pub(crate) strict: bool,
    /// Device with gradients.
    pub(crate) device: Device,
    /// Set by Ctrl-C.
    pub(crate) interrupt: &'a Interrupt,
}

/// The content of that file.
#[derive(Default, Serialize, Deserialize)]
struct FoldScores {
    scores: Vec<FoldScore>,
}

/// A score over all of a fold's people.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FoldScore {
    /// Confidence gate of all classes but relax; none: that of the preset.
    pub(crate) entry_margin: Option<f32>,
    /// The score.
    pub(crate) score: Score,
}

/// A preset with its seed, and a fold from 1 on.
#[derive(Clone, Debug)]
pub(crate) struct Job {
    pub(crate) preset: Preset,
    pub(crate) fold: usize,
}

impl CrossValidation<'_> {
    /// The scores of a job with every wanted confidence gate, if it has been done; none if not, or with other settings or
    /// recordings.
    ///
    /// # Errors
    /// When the preset does not fit the recordings.
    pub(crate) fn done(&self, job: &Job) -> Result<Option<Vec<FoldScore>>, JobError> {
        let Ok(folder) = RunFolder::existing(self.path(job)) else {
            return Ok(None);
        };
        Ok(self.kept(&folder, &self.config(job)?))
    }

    /// The scores in a run folder, if they are those of a configuration and of every wanted confidence gate.
    fn kept(&self, folder: &RunFolder, config: &ResolvedConfig) -> Option<Vec<FoldScore>> {
        let kept = folder.load_stamped::<FoldScores>(SCORES, config.fingerprint());
        let mut scores = kept.ok()?.content.scores;
        let has = |margin: &Option<f32>| scores.iter().any(|own| own.entry_margin == *margin);
        if !self.entry_margins.iter().all(has) {
            return None;
        }
        scores.retain(|own| self.entry_margins.contains(&own.entry_margin));
        Some(scores)
    }

    /// Trains the job's models, or the rest of them, and evaluates the integer student.
    ///
    /// # Errors
    /// When a step fails, the folder holds a run with other settings or the user interrupts.
    pub(crate) fn run(&self, job: &Job) -> Result<(), JobError> {
        let path = self.path(job);
        // Made once: it fingerprints all recordings.
        let config = self.config(job)?;
        let existing = RunFolder::existing(&path).ok();
        if existing.is_some_and(|folder| self.kept(&folder, &config).is_some()) {
            progress::log(&format!("{}: already evaluated", path.display()));
            return Ok(());
        }
        let folder = RunFolder::open(&path)?.locked()?;
        let config = begun(&folder, config)?;
        progress::log(&format!(
            "{}: {} people to train on",
            path.display(),
            config.split.training.len()
        ));
        let context = RunContext {
            folder,
            config,
            library: self.library.clone(),
            device: self.device.clone(),
            resume: true,
            interrupt: self.interrupt.clone(),
        };
        if job.preset.distillation.needs_teacher() {
            train(&context)?;
        }
        distill(&context)?;
        let bytes = quantize(&context, &context.folder.file(MODEL))?;
        let scores = FoldScores {
            scores: self.evaluate(job, bytes)?,
        };
        let made_from = context.config.fingerprint();
        context.folder.save_stamped(SCORES, made_from, &scores)?;
        Ok(())
    }

    /// Run folder of a job.
    pub(crate) fn path(&self, job: &Job) -> PathBuf {
        self.folder
            .join(&job.preset.name)
            .join(format!("seed-{}", job.preset.seed))
            .join(format!("fold-{}", job.fold))
    }

    fn config(&self, job: &Job) -> Result<ResolvedConfig, JobError> {
        let choice = FoldChoice {
            protocol: Protocol::LeaveGroupsOut(self.folds),
            number: job.fold,
        };
        let preset = job.preset.clone();
        let config =
            ResolvedConfig::new(preset, &self.library, self.data, self.strict, Some(choice))?;
        Ok(config)
    }

    /// Scores on the fold's people of all data sets, under both aggregation modes.
    fn evaluate(&self, job: &Job, bytes: Vec<u8>) -> Result<Vec<FoldScore>, JobError> {
        let model = NamedModel {
            name: job.preset.name.clone(),
            bytes,
        };
        let people = fold_people(&job.preset, &self.library, self.folds);
        let selection = Selection {
            subjects: people.into_iter().nth(job.fold - 1).unwrap_or_default(),
            ..Selection::default()
        };
        let mut evaluation = evaluate_models(&[model], &self.library, &selection)?;
        let candidate = &mut evaluation.candidates[0];
        let own_margins = candidate.entry_margins;
        let mut scores = Vec::new();
        for &entry_margin in &self.entry_margins {
            candidate.entry_margins = entry_margin.map_or(own_margins, |margin| {
                EntryMargins::Same(margin).of_classes()
            });
            for look_ahead in [LookAhead::AllRows, LookAhead::SameInstant] {
                let rows = score(
                    candidate,
                    &evaluation.trials,
                    evaluation.vocabulary,
                    look_ahead,
                    Truth::LagCompensated,
                );
                let rows = rows.map_err(StepError::from)?.into_iter();
                scores.extend(rows.map(|score| FoldScore {
                    entry_margin,
                    score,
                }));
            }
        }
        let single = scores.iter().all(|own| own.score.data_set != ALL);
        scores.retain(|own| single || own.score.data_set == ALL);
        Ok(scores)
    }
}
