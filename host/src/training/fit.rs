//! The training loop that teacher and student share: epochs, schedule, checkpoints, resume, Ctrl-C.

use burn::module::Module;
use burn::optim::{AdamWConfig, GradientsAccumulator, GradientsParams, ModuleOptimizer};
use burn::tensor::Tensor;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::ema::Ema;
use crate::execution::interrupt::Interrupt;
use crate::execution::progress;
use crate::execution::run_folder::{RunError, RunFolder};
use crate::training::schedule::{LearningRate, LrSchedule};

/// A training problem: batches, a loss, a validation.
pub trait Learner: Sync {
    /// The network.
    type Model: Module + Sync;
    /// What one optimizer step is drawn from.
    type Item;
    /// WeightedMetric of a step's batch, ready to be computed on.
    type Shard: Send;

    /// Name of the run's files and progress lines.
    fn name(&self) -> &'static str;

    /// The items of one epoch, in the order of their steps.
    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item>;

    /// Number of items of an epoch that the learning rate's schedule counts; whatever comes on top runs
    /// at the end of the schedule, where the rate is 0.
    fn steps(&self) -> usize;

    /// Assembles one step's batch in parts whose losses add up to the step's; in one part, if the model
    /// measures its batches (batch norm).
    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard>;

    /// The loss of one part, to go downhill on, and its named figures, which add up too.
    fn loss(&self, model: &Self::Model, shard: Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>);

    /// Validation of a model without gradients: the loss that chooses the checkpoint, and named figures.
    fn validate(&self, model: &Self::Model) -> (f64, Vec<WeightedMetric>);
}

/// Parts that a step's batch is computed in.
pub const SHARDS: usize = 2;

/// A named figure and the number of cells that it is a mean over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMetric {
    /// Name in the metrics.
    pub name: &'static str,
    /// Mean over the cells.
    pub mean: f64,
    /// Cells.
    pub weight: f64,
}

/// How a model is trained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainConfig {
    /// Passes.
    pub epochs: usize,
    /// Peak learning rate.
    pub learning_rate: f64,
    /// The schedule of the rate.
    pub lr_schedule: LrSchedule,
    /// Decoupled weight decay.
    pub weight_decay: f32,
    /// Decay of the exponential moving average of the weights, which is then validated and saved; 0 saves the
    /// model itself.
    pub ema_decay: f64,
    /// Seed of everything drawn.
    pub seed: u64,
}

/// One line of `NAME.jsonl`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EpochMetrics {
    /// Epoch, 1 first.
    pub epoch: usize,
    /// Optimizer steps so far.
    pub step: usize,
    /// Learning rate of the epoch's last step.
    pub learning_rate: f64,
    /// Training figures, means over the epoch.
    pub train: Vec<(String, f64)>,
    /// The loss that chooses the checkpoint.
    pub validation_loss: f64,
    /// Validation figures.
    pub validation: Vec<(String, f64)>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
struct State {
    epochs_done: usize,
    step: usize,
    best: Option<f64>,
}

/// Trains and returns the checkpoint of the lowest validation loss, `NAME.bpk` in the folder.
///
/// With `resume` a run goes on after its last complete epoch; epochs draw from generators of their
/// own, so a resumed run repeats an uninterrupted one.
///
/// # Errors
/// When the folder cannot be written or the user interrupts.
pub fn fit<L: Learner>(
    learner: &L,
    mut model: L::Model,
    config: TrainConfig,
    run: &RunFolder,
    resume: bool,
    interrupt: &Interrupt,
) -> Result<L::Model, RunError> {
    let name = learner.name();
    let (last, adam) = (format!("{name}-last"), format!("{name}-optimizer"));
    let (state_file, metrics_file) = (format!("{name}-state.json"), format!("{name}.jsonl"));
    let steps = learner.steps();
    let schedule = LearningRate::new(
        config.learning_rate,
        config.lr_schedule,
        config.epochs * steps.max(1),
    );
    let mut optimizer = optimizer(config.weight_decay);
    let mut state = State::default();
    if resume && run.file(&state_file).exists() {
        state = run.load_json(&state_file)?;
        model = run.load_model(&last, model)?;
        optimizer = run.load_optimizer(&adam, optimizer)?;
    }
    let ema_file = format!("{name}-ema");
    let mut ema = if config.ema_decay > 0.0 {
        let mean = match state.step {
            0 => model.clone(),
            _ => run.load_model(&ema_file, model.clone())?,
        };
        Some(Ema::new(&mean, config.ema_decay, state.step))
    } else {
        None
    };
    run.retain_lines(&metrics_file, |line| {
        line["epoch"].as_u64() <= Some(state.epochs_done as u64)
    })?;

    for epoch in state.epochs_done..config.epochs {
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        rng.set_stream(1 + epoch as u64);
        let items = learner.epoch(&mut rng);
        let bar = progress::bar(
            items.len(),
            &format!("{name} epoch {}/{}", epoch + 1, config.epochs),
        );
        let mut means = Means::default();
        let mut rate = 0.0;
        for item in items {
            if interrupt.requested() {
                return Err(run.interrupted());
            }
            rate = schedule.rate(state.step);
            let (gradients, parts) = gradients(learner, &model, learner.shards(&item, &mut rng));
            model = optimizer.step(rate, model, gradients);
            state.step += 1;
            if let Some(ema) = &mut ema {
                ema.add(&model);
            }
            means.add(&parts);
            bar.set_message(means.to_string());
            bar.inc(1);
        }
        bar.finish_and_clear();

        let mean = ema.as_ref().map(|ema| ema.apply(model.clone()));
        let kept = mean.as_ref().unwrap_or(&model);
        let (loss, parts) = learner.validate(&kept.valid());
        let mut validation = Means::default();
        validation.add(&parts);
        progress::log(&format!(
            "{name} epoch {}/{}: train {means}; validation {validation}",
            epoch + 1,
            config.epochs,
        ));
        if state.best.is_none_or(|best| loss < best) {
            state.best = Some(loss);
            run.save_model(name, kept)?;
        }
        if mean.is_some() {
            run.save_model(&ema_file, kept)?;
        }
        state.epochs_done = epoch + 1;
        run.save_model(&last, &model)?;
        run.save_optimizer(&adam, &optimizer)?;
        run.append(
            &metrics_file,
            &EpochMetrics {
                epoch: epoch + 1,
                step: state.step,
                learning_rate: rate,
                train: means.figures(),
                validation_loss: loss,
                validation: validation.figures(),
            },
        )?;
        run.save_json(&state_file, &state)?;
    }
    run.load_model(name, model)
}

/// Gradients of a step: each shard on a thread of its own, summed in the shards' order.
///
/// Two graphs side by side keep two cores busier than one graph whose small operations are split.
pub fn gradients<L: Learner>(
    learner: &L,
    model: &L::Model,
    shards: Vec<L::Shard>,
) -> (GradientsParams, Vec<WeightedMetric>) {
    // A single part is computed on the model itself, so that what it measures of the batch stays with it.
    let shards = match <[L::Shard; 1]>::try_from(shards) {
        Ok([shard]) => {
            let (loss, parts) = learner.loss(model, shard);
            return (GradientsParams::from_grads(loss.backward(), model), parts);
        }
        Err(shards) => shards,
    };
    let done: Vec<_> = shards
        .into_par_iter()
        .map(|shard| {
            // Leaves of its own: graphs that share a leaf are one graph, gone with the first backward pass.
            let model = model.valid().train();
            let (loss, parts) = learner.loss(&model, shard);
            (GradientsParams::from_grads(loss.backward(), &model), parts)
        })
        .collect();
    let mut sum = GradientsAccumulator::new();
    let mut total: Vec<WeightedMetric> = Vec::new();
    for (gradients, parts) in done {
        sum.accumulate(model, gradients);
        for part in parts {
            match total.iter_mut().find(|known| known.name == part.name) {
                Some(known) => {
                    known.mean += part.mean;
                    known.weight += part.weight;
                }
                None => total.push(part),
            }
        }
    }
    (sum.grads(), total)
}

/// AdamW as the reference runs it: betas 0.9 and 0.999, epsilon 1e-8, decay on every parameter.
#[must_use]
pub fn optimizer(weight_decay: f32) -> ModuleOptimizer {
    AdamWConfig::new()
        .with_weight_decay(weight_decay)
        .with_epsilon(1e-8)
        .init()
}

/// Weighted means of named parts, in the order of their first appearance.
#[derive(Default)]
struct Means(Vec<WeightedMetric>);

impl Means {
    fn add(&mut self, parts: &[WeightedMetric]) {
        for part in parts {
            match self.0.iter_mut().find(|known| known.name == part.name) {
                Some(known) => {
                    let weight = known.weight + part.weight;
                    if weight > 0.0 {
                        known.mean += (part.mean - known.mean) * part.weight / weight;
                    }
                    known.weight = weight;
                }
                None => self.0.push(*part),
            }
        }
    }

    fn figures(&self) -> Vec<(String, f64)> {
        self.0
            .iter()
            .map(|part| (part.name.to_owned(), part.mean))
            .collect()
    }
}

impl std::fmt::Display for Means {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (position, part) in self.0.iter().enumerate() {
            let gap = if position == 0 { "" } else { ", " };
            write!(f, "{gap}{} {:.4}", part.name, part.mean)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_weigh_parts_by_their_cells() {
        let mut means = Means::default();
        means.add(&[WeightedMetric {
            name: "a",
            mean: 1.0,
            weight: 1.0,
        }]);
        means.add(&[
            WeightedMetric {
                name: "a",
                mean: 4.0,
                weight: 2.0,
            },
            WeightedMetric {
                name: "b",
                mean: 0.0,
                weight: 0.0,
            },
        ]);
        assert_eq!(
            means.figures(),
            [("a".to_owned(), 3.0), ("b".to_owned(), 0.0)]
        );
    }
}
