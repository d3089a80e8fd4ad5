//! The optimizer steps of one epoch.

use burn::optim::ModuleOptimizer;
use rand_chacha::ChaCha8Rng;

use super::learner::{Learner, WeightedMetric};
use super::metrics::RunningMeans;
use super::optimizer::gradients;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunError;
use presets::training::LearningRate;

/// Epoch of a training.
pub(super) struct Epoch<'a> {
    /// Name in the progress bar.
    pub(super) title: &'a str,
    /// Number of the epoch, from 1.
    pub(super) number: usize,
    /// First step of the epoch in the learning-rate schedule.
    pub(super) first_step: usize,
    pub(super) schedule: &'a LearningRate,
    pub(super) interrupt: &'a Interrupt,
}

/// Position from which an epoch starts: its beginning, or a checkpoint within it.
#[derive(Default)]
pub(super) struct Start {
    /// Number of steps already done.
    pub(super) steps: usize,
    /// Metrics of these steps.
    pub(super) means: RunningMeans,
    /// Position of the generator after these steps; none before the first.
    pub(super) drawn: Option<u128>,
}

/// State of a training after a step.
pub(super) struct Taken<'a, M> {
    pub(super) model: &'a M,
    pub(super) optimizer: &'a ModuleOptimizer,
    /// Number of steps done in the epoch.
    pub(super) steps: usize,
    pub(super) means: &'a RunningMeans,
    pub(super) rng: &'a ChaCha8Rng,
}

/// Result of an epoch.
pub(super) struct Trained<M> {
    pub(super) model: M,
    /// Number of steps.
    pub(super) steps: usize,
    /// Training metrics, over all steps.
    pub(super) means: RunningMeans,
    /// Learning rate of the last step.
    pub(super) rate: f64,
}

impl Epoch<'_> {
    /// Runs the steps of the epoch; calls `after` after each. Returns none if the user interrupts.
    pub(super) fn take<L: Learner>(
        &self,
        learner: &L,
        mut model: L::Model,
        optimizer: &mut ModuleOptimizer,
        rng: &mut ChaCha8Rng,
        start: Start,
        mut after: impl FnMut(Taken<'_, L::Model>) -> Result<(), RunError>,
    ) -> Result<Option<Trained<L::Model>>, RunError> {
        let items = learner.epoch(rng);
        let steps = items.len();
        let bar = progress::bar(steps, self.title);
        bar.inc(start.steps as u64);
        let mut means = start.means;
        let mut rate = match start.steps {
            0 => 0.0,
            taken => self.schedule.rate(self.first_step + taken - 1),
        };
        // The items are drawn again first; then the generator jumps to its position.
        if let Some(drawn) = start.drawn {
            rng.set_word_pos(drawn);
        }
        for (at, item) in items.into_iter().enumerate().skip(start.steps) {
            if self.interrupt.requested() {
                return Ok(None);
            }
            rate = self.schedule.rate(self.first_step + at);
            let (gradients, metrics) = gradients(learner, &model, learner.shards(&item, rng));
            finite(learner.name(), self.number, "training", &metrics)?;
            model = optimizer.step(rate, model, gradients);
            means.add(&metrics);
            after(Taken {
                model: &model,
                optimizer,
                steps: at + 1,
                means: &means,
                rng,
            })?;
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

/// Refuses metrics, each a part of the loss, that are not finite.
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
