//! Checkpoint of a training, after an epoch or within it. It is one file, replaced by one rename; training resumes bit for bit.

use burn::module::Module;
use burn::optim::ModuleOptimizer;
use burn::tensor::Bytes;
use serde::{Deserialize, Serialize};

use super::metrics::RunningMeans;
use crate::weights::{load_model_bytes, model_bytes};
use execution::fingerprint::Fingerprint;
use execution::run_folder::EpochMetrics;
use execution::run_folder::{Artefact, RunError, RunFolder, write_whole};

const MODEL: &str = "model";
const OPTIMIZER: &str = "optimizer";
/// Part with the average of the weights, if the training keeps one.
const AVERAGE: &str = "average";
/// Part with the weights of the lowest validation loss.
const BEST: &str = "best";

/// Progress of a training.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct TrainingProgress {
    /// Number of optimizer steps in complete epochs.
    pub(super) step: usize,
    /// Lowest validation loss; none before the first epoch is complete.
    pub(super) best_loss: Option<f64>,
    /// Metrics of every epoch.
    pub(super) epochs: Vec<EpochMetrics>,
    /// Progress within the current epoch; none at its start.
    #[serde(default)]
    pub(super) within: Option<Within>,
}

/// Progress within an epoch.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Within {
    /// Optimizer steps of the epoch, which [`TrainingProgress::step`] does not count.
    pub(super) steps: usize,
    /// Position of the epoch's generator.
    pub(super) drawn: u64,
    /// Metrics of these steps.
    pub(super) means: RunningMeans,
}

/// State of a training, from which it resumes.
pub(super) struct Checkpoint<M> {
    pub(super) progress: TrainingProgress,
    pub(super) model: M,
    pub(super) optimizer: ModuleOptimizer,
    /// Average of the weights, if one is kept.
    pub(super) average: Option<M>,
    /// The model of the lowest validation loss, as bytes: a clone would share the statistics of its batch norms.
    pub(super) best: Vec<u8>,
}

impl<M> Checkpoint<M> {
    /// State before the first step.
    pub(super) fn new(model: M, optimizer: ModuleOptimizer) -> Self {
        Self {
            progress: TrainingProgress::default(),
            model,
            optimizer,
            average: None,
            best: Vec::new(),
        }
    }
}

/// Files of one training in a run folder.
pub(super) struct Store<'a> {
    pub(super) run: &'a RunFolder,
    /// Name of the training.
    pub(super) name: &'a str,
    /// Fingerprint of all that determines the training: what its weights depend on, and its settings.
    pub(super) made_from: Fingerprint,
}

/// Line of the metrics file.
#[derive(Serialize)]
struct MetricsLine<'a> {
    made_from: Fingerprint,
    #[serde(flatten)]
    metrics: &'a EpochMetrics,
}

impl Store<'_> {
    /// Removes the files of an earlier training.
    pub(super) fn clear(&self) -> Result<(), RunError> {
        let paths = [
            self.run.checkpoint_path(self.name),
            self.run.metrics_path(self.name),
        ];
        let names: Vec<_> = paths
            .iter()
            .filter_map(|path| path.file_name()?.to_str())
            .collect();
        self.run.remove_files(&names)
    }

    /// Loads the last checkpoint; none before the first one was saved.
    pub(super) fn load<M: Module>(
        &self,
        model: &M,
        optimizer: ModuleOptimizer,
    ) -> Result<Option<Checkpoint<M>>, RunError> {
        let path = self.run.checkpoint_path(self.name);
        if !path.exists() {
            return Ok(None);
        }
        let mut artefact = self.run.load_artefact(&path)?;
        if artefact.made_from != self.made_from {
            return Err(RunError::OtherTraining { path });
        }
        let average = artefact.take(AVERAGE).ok();
        let weights = |bytes| load_model_bytes(&path, bytes, model.clone());
        let optimizer = optimizer.from_bytes(Bytes::from_bytes_vec(artefact.take(OPTIMIZER)?));
        let checkpoint = Checkpoint {
            progress: artefact.about()?,
            optimizer: optimizer.map_err(|error| RunError::content(&path, error))?,
            model: weights(artefact.take(MODEL)?)?,
            best: artefact.take(BEST)?,
            average: average.map(weights).transpose()?,
        };
        self.save_metrics(&checkpoint.progress)?;
        Ok(Some(checkpoint))
    }

    /// Saves a checkpoint in place of the last one, then writes the metrics file.
    pub(super) fn save<M: Module>(&self, checkpoint: &Checkpoint<M>) -> Result<(), RunError> {
        let path = self.run.checkpoint_path(self.name);
        let optimizer = checkpoint.optimizer.into_bytes();
        let optimizer = optimizer.map_err(|error| RunError::content(&path, error))?;
        let model = model_bytes(&path, &checkpoint.model)?;
        let average = checkpoint.average.as_ref();
        let average = average.map(|own| model_bytes(&path, own)).transpose()?;
        let mut artefact = Artefact::new(path, self.made_from, &checkpoint.progress)?
            .with(MODEL, model)
            .with(OPTIMIZER, optimizer.to_vec())
            .with(BEST, checkpoint.best.clone());
        if let Some(average) = average {
            artefact = artefact.with(AVERAGE, average);
        }
        artefact.save()?;
        self.save_metrics(&checkpoint.progress)
    }

    /// Writes the metrics file from the checkpoint's metrics.
    fn save_metrics(&self, progress: &TrainingProgress) -> Result<(), RunError> {
        let path = self.run.metrics_path(self.name);
        let mut text = String::new();
        for metrics in &progress.epochs {
            let line = MetricsLine {
                made_from: self.made_from,
                metrics,
            };
            text +=
                &serde_json::to_string(&line).map_err(|error| RunError::content(&path, error))?;
            text.push('\n');
        }
        write_whole(&path, text.as_bytes())
    }
}
