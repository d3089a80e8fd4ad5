//! One optimizer step: gradients of a batch in shards, and AdamW.

use burn::module::Module as _;
use burn::optim::{AdamWConfig, GradientsAccumulator, GradientsParams, ModuleOptimizer};
use rayon::prelude::*;

use super::learner::{Learner, WeightedMetric};

/// AdamW with the reference's settings: betas 0.9 and 0.999, epsilon 1e-8, decay on every parameter.
pub fn optimizer(weight_decay: f32) -> ModuleOptimizer {
    AdamWConfig::new()
        .with_weight_decay(weight_decay)
        .with_epsilon(1e-8)
        .init()
}

/// Computes gradients and metrics of a step: each shard on its own thread, summed in the order of the shards.
///
/// Two graphs at a time keep two cores busier than one graph whose small operations are split.
pub fn gradients<L: Learner>(
    learner: &L,
    model: &L::Model,
    shards: Vec<L::Shard>,
) -> (GradientsParams, Vec<WeightedMetric>) {
    // A single shard runs on the model itself, which then keeps the running statistics of batch norm.
    let shards = match <[L::Shard; 1]>::try_from(shards) {
        Ok([shard]) => {
            let (loss, metrics) = learner.loss(model, shard);
            return (GradientsParams::from_grads(loss.backward(), model), metrics);
        }
        Err(shards) => shards,
    };
    let done: Vec<_> = shards
        .into_par_iter()
        .map(|shard| {
            // Fresh leaves: graphs that share a leaf are one graph, and the first backward pass would free it.
            let model = model.valid().train();
            let (loss, metrics) = learner.loss(&model, shard);
            (
                GradientsParams::from_grads(loss.backward(), &model),
                metrics,
            )
        })
        .collect();
    let mut sum = GradientsAccumulator::new();
    let mut totals: Vec<WeightedMetric> = Vec::new();
    for (gradients, metrics) in done {
        sum.accumulate(model, gradients);
        for metric in metrics {
            match totals.iter_mut().find(|known| known.name == metric.name) {
                Some(known) => {
                    known.mean += metric.mean;
                    known.weight += metric.weight;
                }
                None => totals.push(metric),
            }
        }
    }
    (sum.grads(), totals)
}
