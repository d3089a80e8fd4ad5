//! The optimizer steps of one epoch.

use burn::optim::ModuleOptimizer;
use rand_chacha::ChaCha8Rng;

use super::learner::{Learner, WeightedMetric};
use super::metrics::RunningMeans;
use super::optimizer::gradients;
use super::schedule::LearningRate;
use crate::execution::interrupt::Interrupt;
use crate::execution::progress;
use crate::execution::run_folder::RunError;

/// One epoch of a training.
pub(super) struct Epoch<'a> {
    /// Name in the progress bar.
    pub(super) title: &'a str,
    /// From 1 on.
    pub(super) number: usize,
    pub(super) schedule: &'a LearningRate,
    pub(super) interrupt: &'a Interrupt,
}

/// A model after an epoch.
pub(super) struct Trained<M> {
    pub(super) model: M,
    /// Number of steps.
    pub(super) steps: usize,
    /// Metrics of the training, over its steps.
    pub(super) means: RunningMeans,
    /// Learning rate of its last step.
    pub(super) rate: f64,
}

impl Epoch<'_> {
    /// Takes the steps, from `step` of the schedule on; `after` sees the model after each. None if the user interrupts.
    ///
    /// # Errors
    /// When a loss is infinite or no number.
    pub(super) fn take<L: Learner>(
        &self,
        learner: &L,
        mut model: L::Model,
        optimizer: &mut ModuleOptimizer,
        step: usize,
        rng: &mut ChaCha8Rng,
        mut after: impl FnMut(&L::Model),
    ) -> Result<Option<Trained<L::Model>>, RunError> {
        let items = learner.epoch(rng);
        let steps = items.len();
        let bar = progress::bar(steps, self.title);
        let mut means = RunningMeans::default();
        let mut rate = 0.0;
        for (at, item) in items.into_iter().enumerate() {
            if self.interrupt.requested() {
                return Ok(None);
            }
            rate = self.schedule.rate(step + at);
            let (gradients, metrics) = gradients(learner, &model, learner.shards(&item, rng));
            finite(learner.name(), self.number, "training", &metrics)?;
            model = optimizer.step(rate, model, gradients);
            after(&model);
            means.add(&metrics);
            bar.set_message(means.to_string());
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(Some(Trained {
            model,
            steps,
            means,
            rate,
        }))
    }
}

/// Refuses metrics, each a part of the loss, that are infinite or no number.
pub(super) fn finite(
    name: &str,
    epoch: usize,
    what: &str,
    metrics: &[WeightedMetric],
) -> Result<(), RunError> {
    let wrong = metrics
        .iter()
        .find(|metric| metric.weight > 0.0 && !metric.mean.is_finite());
    match wrong {
        None => Ok(()),
        Some(metric) => Err(RunError::Diverged {
            name: name.to_owned(),
            epoch,
            what: format!("{what} loss ({})", metric.name),
            loss: metric.mean,
        }),
    }
}
