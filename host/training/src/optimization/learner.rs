//! Interface between the training loop and a model with its data.

use burn::module::Module;
use burn::tensor::Tensor;
use rand_chacha::ChaCha8Rng;

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

    /// Validates a model without gradients: the loss that selects the checkpoint, and metrics.
    fn validate(&self, model: &Self::Model) -> (f64, Vec<WeightedMetric>);
}

/// Number of parts that a step's batch is computed in, each on its own thread.
pub const SHARDS: usize = 2;

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
