//! The training loop: epochs, schedule, checkpoints, resume, interrupt.

use std::time::{Duration, Instant};

use burn::module::Module as _;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::checkpoint::{Checkpoint, Snapshot, Store, TrainingProgress, Within};
use super::ema::Ema;
use super::epoch::{Epoch, Taken, Trained, finite};
use super::learner::{Learner, WeightedMetric};
use super::metrics::{RunningMeans, recorded};
use super::optimizer::optimizer;
use crate::weights::{Weights as _, load_model_bytes, model_bytes};
use execution::fingerprint::Fingerprint;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::EpochMetrics;
use execution::run_folder::{RunError, RunFolder};
use presets::training::LearningRate;
pub use presets::training::TrainConfig;

/// Time between checkpoints within an epoch: the most that an interruption loses.
pub const CHECKPOINT_EVERY: Duration = Duration::from_mins(5);

/// Settings of a training: its files, and what they belong to.
#[derive(Clone, Copy, Debug)]
pub struct Training<'a> {
    /// The run folder.
    pub run: &'a RunFolder,
    /// Fingerprint of all that the weights depend on, apart from [`TrainConfig`] and the learner's name and steps.
    pub made_from: Fingerprint,
    /// Whether to continue after the last checkpoint.
    pub resume: bool,
    /// Time after which the next step writes a checkpoint; the end of an epoch always writes one.
    pub checkpoint_every: Duration,
    /// The user's request to stop.
    pub interrupt: &'a Interrupt,
}

/// Trains a model and returns the weights of the lowest validation loss, which are also saved in the run folder as `NAME.bpk`.
///
/// Each epoch draws from a generator of its own, whose position is part of a checkpoint, so a resumed training gives the
/// same weights as an uninterrupted one.
pub fn fit<L: Learner>(
    learner: &L,
    model: L::Model,
    config: TrainConfig,
    training: &Training<'_>,
) -> Result<L::Model, RunError> {
    let (name, steps, run) = (learner.name(), learner.steps(), training.run);
    let schedule = LearningRate::new(
        config.learning_rate,
        config.lr_schedule,
        config.epochs * steps.max(1),
    );
    let store = Store {
        run,
        name,
        made_from: Fingerprint::of(&(training.made_from, name, config, steps)),
    };
    if !training.resume {
        store.clear()?;
    }
    let fresh = optimizer(config.weight_decay);
    let mut checkpoint = match store.load(&model, fresh.clone())? {
        Some(checkpoint) => checkpoint,
        None => Checkpoint {
            progress: TrainingProgress::default(),
            optimizer: fresh,
            average: (config.ema_decay > 0.0).then(|| model.clone()),
            best: Vec::new(),
            model,
        },
    };
    let mut step = checkpoint.progress.step;
    let mut start = checkpoint.progress.within.take().map(Within::start);
    let taken = step + start.as_ref().map_or(0, |start| start.steps);
    let mut ema = checkpoint
        .average
        .as_ref()
        .map(|average| Ema::new(average, config.ema_decay, taken));
    let mut saved = Instant::now();

    for epoch in checkpoint.progress.epochs.len() + 1..=config.epochs {
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        rng.set_stream(epoch as u64);
        let title = format!("{name} epoch {epoch}/{}", config.epochs);
        let steps = Epoch {
            title: &title,
            number: epoch,
            first_step: step,
            schedule: &schedule,
            interrupt: training.interrupt,
        };
        let progress = &mut checkpoint.progress;
        let best = &checkpoint.best;
        let after = |taken: Taken<'_, L::Model>| {
            if let Some(ema) = &mut ema {
                ema.add(taken.model);
            }
            if saved.elapsed() < training.checkpoint_every && !training.interrupt.requested() {
                return Ok(());
            }
            progress.within = Some(Within::after(&taken));
            let average = ema.as_ref().map(|ema| ema.apply(taken.model.clone()));
            store.save(&Snapshot {
                progress,
                model: taken.model,
                optimizer: taken.optimizer,
                average: average.as_ref(),
                best,
            })?;
            saved = Instant::now();
            Ok(())
        };
        let done = steps.take(
            learner,
            checkpoint.model,
            &mut checkpoint.optimizer,
            &mut rng,
            start.take().unwrap_or_default(),
            after,
        )?;
        let Some(trained) = done else {
            return Err(run.interrupted());
        };
        let Trained { means, rate, .. } = trained;
        checkpoint.model = trained.model;
        step += trained.steps;

        checkpoint.average = ema.as_ref().map(|ema| ema.apply(checkpoint.model.clone()));
        let kept = checkpoint.average.as_ref().unwrap_or(&checkpoint.model);
        let (loss, metrics) = learner.validate(&kept.valid());
        let loss = recorded(loss);
        let selecting = WeightedMetric {
            name: "selecting",
            mean: loss,
            weight: 1.0,
        };
        finite(name, epoch, "validation", &[selecting])?;
        let mut validation = RunningMeans::default();
        validation.add(&metrics);
        progress::log(&format!("{title}: train {means}; validation {validation}"));
        let best = checkpoint.progress.best_loss;
        if best.is_none_or(|best| loss < best) {
            checkpoint.progress.best_loss = Some(loss);
            checkpoint.best = model_bytes(&run.checkpoint_path(name), kept)?;
        }
        checkpoint.progress.step = step;
        checkpoint.progress.within = None;
        checkpoint.progress.epochs.push(EpochMetrics {
            epoch,
            step,
            learning_rate: recorded(rate),
            train: means.by_name(),
            validation_loss: loss,
            validation: validation.by_name(),
        });
        store.save(&Snapshot {
            progress: &checkpoint.progress,
            model: &checkpoint.model,
            optimizer: &checkpoint.optimizer,
            average: checkpoint.average.as_ref(),
            best: &checkpoint.best,
        })?;
        saved = Instant::now();
    }
    let best = load_model_bytes(
        &run.checkpoint_path(name),
        checkpoint.best,
        checkpoint.model,
    )?;
    run.save_model(name, training.made_from, &best)?;
    Ok(best)
}

#[cfg(test)]
mod tests;
