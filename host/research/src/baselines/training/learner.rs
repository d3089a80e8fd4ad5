//! Training problem of a baseline's network, for the product's training loop.

use std::marker::PhantomData;

use burn::tensor::{Device, Tensor};
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::batch::Batch;
use crate::baselines::Baseline;
use crate::baselines::features::FeatureExtraction;
use crate::baselines::networks::Network;
use crate::baselines::windows::{Window, WindowedCorpus};
use training::optimization::learner::{Learner, WeightedMean, WeightedMetric, shards};
use training::optimization::read_back;

pub(super) struct NetworkLearner<'a, N> {
    pub(super) baseline: Baseline,
    pub(super) features: FeatureExtraction,
    pub(super) training: WindowedCorpus,
    pub(super) validation: WindowedCorpus,
    pub(super) batch: usize,
    pub(super) device: &'a Device,
    pub(super) network: PhantomData<fn() -> N>,
}

impl<N: Network> Learner for NetworkLearner<'_, N> {
    type Model = N;
    type Item = Vec<Window>;
    type Shard = Batch;

    fn name(&self) -> &'static str {
        self.baseline.file_stem()
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item> {
        let mut order = self.training.windows.clone();
        order.shuffle(rng);
        order.chunks(self.batch).map(<[_]>::to_vec).collect()
    }

    fn steps(&self) -> usize {
        self.training.windows.len().div_ceil(self.batch)
    }

    fn shards(&self, item: &Self::Item, _: &mut ChaCha8Rng) -> Vec<Self::Shard> {
        let mut shards = shards(item, |windows| {
            Batch::new(&self.features, &self.training, windows, self.device)
        });
        // Means are over the whole step, so that the shards' losses add up to the step's.
        let targets = shards.iter().map(|batch| batch.targets).sum();
        for batch in &mut shards {
            batch.targets = targets;
        }
        shards
    }

    fn loss(&self, model: &N, batch: Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>) {
        let loss = batch.loss(model.forward(batch.input.clone()));
        let metric = WeightedMetric::of_loss("label", &loss, batch.targets);
        (loss, vec![metric])
    }

    fn validate(&self, model: &N) -> (f64, Vec<(&'static str, f64)>) {
        let device = self.device.clone().inner();
        let (mut loss, mut accuracy) = (WeightedMean::default(), WeightedMean::default());
        for windows in self.validation.windows.chunks(self.batch) {
            let batch = Batch::new(&self.features, &self.validation, windows, &device);
            let logits = model.forward(batch.input.clone());
            accuracy.add(batch.accuracy(logits.clone()), batch.targets);
            loss.add(read_back(batch.loss(logits))[0], batch.targets);
        }
        let metrics = vec![("label", loss.mean()), ("accuracy", accuracy.mean())];
        (loss.mean(), metrics)
    }
}
