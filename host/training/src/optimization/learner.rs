//! Interface between the training loop and a model with its data.

use burn::module::Module;
use burn::tensor::Tensor;
use rand_chacha::ChaCha8Rng;

use super::read_back;

/// A training problem: batches, a loss, a validation.
pub trait Learner: Sync {
    /// The network.
    type Model: Module + Sync;
    /// Description of one optimizer step's batch, for instance a list of windows.
    type Item;
    /// Part of a step's batch, as tensors.
    type Shard: Send;

    /// Name of the files in the run folder and of the lines in the log.
    fn name(&self) -> &'static str;

    /// Draws the items of one epoch: one a step, in order.
    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item>;

    /// Number of steps of an epoch in the learning-rate schedule. [`epoch`](Self::epoch) may return more: once the schedule has
    /// ended, the rate is 0.
    fn steps(&self) -> usize;

    /// Assembles one step's batch in parts whose losses add up to the loss of the batch. A model with batch norm needs the batch
    /// in one part.
    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard>;

    /// Computes the loss of one part, which is minimized, and its metrics. Both add up over the parts of a batch.
    fn loss(&self, model: &Self::Model, shard: Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>);

    /// Validates a model without gradients: the loss that selects the checkpoint, and metrics by name.
    fn validate(&self, model: &Self::Model) -> (f64, Vec<(&'static str, f64)>);
}

/// Number of parts that a step's batch is computed in, each on its own thread.
const SHARDS: usize = 2;

/// Divides the examples of a step's batch into shards, each assembled by `assemble`.
pub fn shards<T, S>(examples: &[T], assemble: impl FnMut(&[T]) -> S) -> Vec<S> {
    let size = examples.len().div_ceil(SHARDS);
    examples.chunks(size).map(assemble).collect()
}

/// Named mean and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMetric {
    /// Name in the metrics file.
    pub name: &'static str,
    /// The mean.
    pub mean: f64,
    /// Number of values in the mean.
    pub weight: f64,
}

impl WeightedMetric {
    /// Metric of a loss, with its weight in the mean over batches.
    pub fn of_loss(name: &'static str, loss: &Tensor<1>, weight: f64) -> Self {
        Self {
            name,
            mean: f64::from(read_back(loss.clone())[0]),
            weight,
        }
    }
}

/// Mean of the means of batches, each weighted with its number of values.
#[derive(Clone, Copy, Debug, Default)]
pub struct WeightedMean {
    sum: f64,
    weight: f64,
}

impl WeightedMean {
    /// Adds the mean of a batch over `weight` values.
    pub fn add(&mut self, mean: f32, weight: f64) {
        self.sum += f64::from(mean) * weight;
        self.weight += weight;
    }

    /// The mean; 0 without a value.
    pub fn mean(&self) -> f64 {
        self.sum / self.weight.max(1.0)
    }
}
