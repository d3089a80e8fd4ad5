//! Training problem of a baseline's network, for the product's training loop.

use std::marker::PhantomData;

use burn::tensor::{Device, Tensor};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::batch::Batch;
use super::data::TrainingData;
use super::{Setup, TrainingError};
use crate::baselines::networks::Network;
use crate::baselines::windows::Window;
use presets::training::LrSchedule;
use training::optimization::dropout::Dropout;
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
    type Shard = (Batch, ChaCha8Rng);

    fn name(&self) -> &'static str {
        self.data.baseline().file_stem()
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item> {
        let mut order = self.data.training.windows.clone();
        order.shuffle(rng);
        let mut items: Vec<Vec<Window>> = order.chunks(self.batch).map(<[_]>::to_vec).collect();
        // Batch norm needs more windows for its statistics than the last, incomplete batch may have.
        if N::BATCH_NORM && items.len() > 1 && !order.len().is_multiple_of(self.batch) {
            items.pop();
        }
        items
    }

    fn steps(&self) -> usize {
        self.data.training.windows.len().div_ceil(self.batch)
    }

    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard> {
        let count = if N::BATCH_NORM { 1 } else { SHARDS };
        let mut shards: Vec<Self::Shard> = item
            .chunks(item.len().div_ceil(count))
            .map(|windows| {
                let batch = Batch::new(
                    self.data.features(),
                    &self.data.training,
                    windows,
                    self.device,
                );
                (batch, ChaCha8Rng::from_rng(rng))
            })
            .collect();
        // Means are over the whole step, so that the shards' losses add up to the step's.
        let targets = shards.iter().map(|(batch, _)| batch.targets).sum();
        for (batch, _) in &mut shards {
            batch.targets = targets;
        }
        shards
    }

    fn loss(&self, model: &N, (batch, rng): Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>) {
        let mut losses = model
            .forward(batch.input.clone(), &mut Dropout::from(rng))
            .into_iter()
            .map(|logits| batch.loss(logits));
        let prediction = losses.next().expect("a network has a head");
        let metric = WeightedMetric {
            name: "label",
            mean: f64::from(read_back(prediction.clone())[0]),
            weight: batch.targets,
        };
        (
            losses.fold(prediction, |sum, loss| sum + loss),
            vec![metric],
        )
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
            let logits = model
                .forward(batch.input.clone(), &mut Dropout::off())
                .remove(0);
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
