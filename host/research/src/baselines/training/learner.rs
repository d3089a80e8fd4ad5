//! Training problem of a baseline's network, for the product's training loop.

use std::marker::PhantomData;

use burn::tensor::{Device, Tensor};
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::batch::Batch;
use super::data::TrainingData;
use super::{Setup, TrainingError};
use crate::baselines::networks::Network;
use crate::baselines::windows::Window;
use presets::training::LrSchedule;
use training::optimization::fit::{TrainConfig, Training};
use training::optimization::learner::{Learner, SHARDS, WeightedMetric};
use training::optimization::read_back;

/// Trains a network and saves the weights of the lowest validation loss.
pub(super) fn fit<N: Network>(
    data: TrainingData,
    network: N,
    setup: &Setup<'_>,
    place: &Training<'_>,
) -> Result<(), TrainingError> {
    let settings = setup.settings;
    let config = TrainConfig {
        epochs: settings.epochs,
        learning_rate: settings.learning_rate,
        lr_schedule: LrSchedule::Constant,
        weight_decay: settings.weight_decay,
        ema_decay: 0.0,
        seed: setup.seed,
    };
    let learner = NetworkLearner {
        data,
        batch: settings.batch,
        device: setup.device,
        network: PhantomData,
    };
    training::optimization::fit::fit(&learner, network, config, place)?;
    Ok(())
}

struct NetworkLearner<'a, N> {
    data: TrainingData,
    /// Number of windows per optimizer step.
    batch: usize,
    device: &'a Device,
    network: PhantomData<fn() -> N>,
}

impl<N: Network> Learner for NetworkLearner<'_, N> {
    type Model = N;
    type Item = Vec<Window>;
    type Shard = Batch;

    fn name(&self) -> &'static str {
        self.data.baseline().file_stem()
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item> {
        let mut order = self.data.training.windows.clone();
        order.shuffle(rng);
        order.chunks(self.batch).map(<[_]>::to_vec).collect()
    }

    fn steps(&self) -> usize {
        self.data.training.windows.len().div_ceil(self.batch)
    }

    fn shards(&self, item: &Self::Item, _: &mut ChaCha8Rng) -> Vec<Self::Shard> {
        let mut shards: Vec<Self::Shard> = item
            .chunks(item.len().div_ceil(SHARDS))
            .map(|windows| {
                Batch::new(
                    self.data.features(),
                    &self.data.training,
                    windows,
                    self.device,
                )
            })
            .collect();
        // Means are over the whole step, so that the shards' losses add up to the step's.
        let targets = shards.iter().map(|batch| batch.targets).sum();
        for batch in &mut shards {
            batch.targets = targets;
        }
        shards
    }

    fn loss(&self, model: &N, batch: Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>) {
        let loss = batch.loss(model.forward(batch.input.clone()));
        let metric = WeightedMetric {
            name: "label",
            mean: f64::from(read_back(loss.clone())[0]),
            weight: batch.targets,
        };
        (loss, vec![metric])
    }

    fn validate(&self, model: &N) -> (f64, Vec<WeightedMetric>) {
        let device = self.device.clone().inner();
        let (mut loss, mut correct, mut targets) = (0.0, 0.0, 0.0);
        for windows in self.data.validation.windows.chunks(self.batch) {
            let batch = Batch::new(
                self.data.features(),
                &self.data.validation,
                windows,
                &device,
            );
            let logits = model.forward(batch.input.clone());
            correct += batch.correct(logits.clone());
            loss += f64::from(read_back(batch.loss(logits))[0]) * batch.targets;
            targets += batch.targets;
        }
        let metric = |name, sum: f64| WeightedMetric {
            name,
            mean: sum / f64::max(targets, 1.0),
            weight: 1.0,
        };
        let loss = metric("label", loss);
        (loss.mean, vec![loss, metric("accuracy", correct)])
    }
}
