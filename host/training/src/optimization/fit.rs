//! The training loop: epochs, schedule, checkpoints, resume, interrupt.

use std::time::{Duration, Instant};

use burn::module::Module as _;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::checkpoint::{Checkpoint, Store, Within};
use super::ema::Ema;
use super::epoch::{Epoch, finite};
use super::learner::Learner;
use super::metrics::{RunningMeans, recorded};
use super::optimizer::optimizer;
use crate::weights::{load_model_bytes, model_bytes, save_model};
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
            average: (config.ema_decay > 0.0).then(|| model.clone()),
            ..Checkpoint::new(model, fresh)
        },
    };
    let progress = &checkpoint.progress;
    let taken = progress.step + progress.within.as_ref().map_or(0, |within| within.steps);
    let mut ema = checkpoint
        .average
        .as_ref()
        .map(|average| Ema::new(average, config.ema_decay, taken));
    let mut saved = Instant::now();

    for number in progress.epochs.len() + 1..=config.epochs {
        let title = format!("{name} epoch {number}/{}", config.epochs);
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        rng.set_stream(number as u64);
        let epoch = Epoch {
            title: &title,
            number,
            schedule: &schedule,
            rng,
            interrupt: training.interrupt,
        };
        let after = |checkpoint: &mut Checkpoint<L::Model>| {
            if let Some(ema) = &mut ema {
                ema.add(&checkpoint.model);
            }
            if saved.elapsed() < training.checkpoint_every && !training.interrupt.requested() {
                return Ok(());
            }
            checkpoint.average = ema.as_ref().map(|ema| ema.apply(checkpoint.model.clone()));
            store.save(checkpoint)?;
            saved = Instant::now();
            Ok(())
        };
        let done = epoch.take(learner, checkpoint, after)?;
        checkpoint = done.ok_or_else(|| run.interrupted())?;

        checkpoint.average = ema.as_ref().map(|ema| ema.apply(checkpoint.model.clone()));
        let kept = checkpoint.average.as_ref().unwrap_or(&checkpoint.model);
        let (loss, metrics) = learner.validate(&kept.valid());
        let (loss, validation) = (recorded(loss), RunningMeans::of(metrics));
        finite(name, number, "validation loss (selecting)".to_owned(), loss)?;
        let progress = &mut checkpoint.progress;
        let Within { steps, means, .. } = progress.within.take().unwrap_or_default();
        progress::log(&format!("{title}: train {means}; validation {validation}"));
        if progress.best_loss.is_none_or(|best| loss < best) {
            progress.best_loss = Some(loss);
            checkpoint.best = model_bytes(&run.checkpoint_path(name), kept)?;
        }
        progress.step += steps;
        let last = progress.step.checked_sub(1).filter(|_| steps > 0);
        progress.epochs.push(EpochMetrics {
            epoch: number,
            step: progress.step,
            learning_rate: recorded(last.map_or(0.0, |last| schedule.rate(last))),
            train: means.by_name(),
            validation_loss: loss,
            validation: validation.by_name(),
        });
        store.save(&checkpoint)?;
        saved = Instant::now();
    }
    let best = load_model_bytes(
        &run.checkpoint_path(name),
        checkpoint.best,
        checkpoint.model,
    )?;
    save_model(run, name, training.made_from, &best)?;
    Ok(best)
}

#[cfg(test)]
mod tests;
