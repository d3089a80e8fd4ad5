//! What the training loop needs to know of a model and its data.

use burn::module::Module;
use burn::tensor::Tensor;
use rand_chacha::ChaCha8Rng;

/// A training problem: batches, a loss, a validation.
pub trait Learner: Sync {
    /// The network.
    type Model: Module + Sync;
    /// What one optimizer step's batch is assembled from, a list of windows for instance.
    type Item;
    /// One part of a step's batch, as tensors.
    type Shard: Send;

    /// Name of the files in the run folder and of the lines in the log.
    fn name(&self) -> &'static str;

    /// The items of one epoch, one an optimizer step, in order.
    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item>;

    /// Steps of an epoch that the learning-rate schedule counts. [`epoch`](Self::epoch) may return more:
    /// once the schedule has ended, the rate is 0.
    fn steps(&self) -> usize;

    /// Assembles one step's batch in parts whose losses add up to the loss of the batch. A model that
    /// computes statistics of its batch (batch norm) needs the batch in one part.
    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard>;

    /// The loss of one part, which is minimized, and its metrics. Both add up over the parts of a batch.
    fn loss(&self, model: &Self::Model, shard: Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>);

    /// Validates a model without gradients: the loss that selects the checkpoint, and metrics.
    fn validate(&self, model: &Self::Model) -> (f64, Vec<WeightedMetric>);
}

/// Parts that a step's batch is computed in, on a thread each.
pub const SHARDS: usize = 2;

/// A named mean and its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMetric {
    /// Name in the metrics file.
    pub name: &'static str,
    /// The mean.
    pub mean: f64,
    /// Number of values that it is the mean of.
    pub weight: f64,
}
