//! The training loop: epochs, schedule, checkpoints, resume, interrupt.

use burn::module::Module;
use burn::optim::ModuleOptimizer;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::ema::Ema;
use super::learner::Learner;
use super::metrics::{EpochMetrics, RunningMeans};
use super::optimizer::{gradients, optimizer};
use super::schedule::{LearningRate, LrSchedule};
use crate::execution::interrupt::Interrupt;
use crate::execution::progress;
use crate::execution::run_folder::{RunError, RunFolder};

/// How a model is trained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrainConfig {
    /// Number of epochs.
    pub epochs: usize,
    /// Peak learning rate.
    pub learning_rate: f64,
    /// Schedule of the learning rate.
    pub lr_schedule: LrSchedule,
    /// Decoupled weight decay.
    pub weight_decay: f32,
    /// Decay of the exponential moving average of the weights, which is then validated and saved; 0 saves
    /// the weights themselves.
    pub ema_decay: f64,
    /// Seed of every random draw.
    pub seed: u64,
}

/// What a resumed run needs to know beside weights and optimizer.
#[derive(Debug, Default, Serialize, Deserialize)]
struct State {
    epochs_done: usize,
    step: usize,
    /// Lowest validation loss so far.
    best: Option<f64>,
}

/// Trains and returns the checkpoint of the lowest validation loss, `NAME.bpk` in the run folder.
///
/// With `resume` a run continues after its last complete epoch. Each epoch draws from a generator of
/// its own, so a resumed run gives the same weights as an uninterrupted one.
///
/// # Errors
/// When the folder cannot be written or the user interrupts.
pub fn fit<L: Learner>(
    learner: &L,
    model: L::Model,
    config: TrainConfig,
    run: &RunFolder,
    resume: bool,
    interrupt: &Interrupt,
) -> Result<L::Model, RunError> {
    let name = learner.name();
    let files = Files::of(name, run);
    let steps = learner.steps();
    let schedule = LearningRate::new(
        config.learning_rate,
        config.lr_schedule,
        config.epochs * steps.max(1),
    );
    let (mut model, mut optimizer, mut state) =
        files.start(model, optimizer(config.weight_decay), resume)?;
    let mut ema = files.ema(&model, config.ema_decay, state.step)?;

    for epoch in state.epochs_done..config.epochs {
        let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
        rng.set_stream(1 + epoch as u64);
        let title = format!("{name} epoch {}/{}", epoch + 1, config.epochs);
        let items = learner.epoch(&mut rng);
        let bar = progress::bar(items.len(), &title);
        let mut training = RunningMeans::default();
        let mut rate = 0.0;
        for item in items {
            if interrupt.requested() {
                return Err(run.interrupted());
            }
            rate = schedule.rate(state.step);
            let (gradients, metrics) = gradients(learner, &model, learner.shards(&item, &mut rng));
            model = optimizer.step(rate, model, gradients);
            state.step += 1;
            if let Some(ema) = &mut ema {
                ema.add(&model);
            }
            training.add(&metrics);
            bar.set_message(training.to_string());
            bar.inc(1);
        }
        bar.finish_and_clear();

        let average = ema.as_ref().map(|ema| ema.apply(model.clone()));
        let kept = average.as_ref().unwrap_or(&model);
        let (loss, metrics) = learner.validate(&kept.valid());
        let mut validation = RunningMeans::default();
        validation.add(&metrics);
        progress::log(&format!(
            "{title}: train {training}; validation {validation}"
        ));
        if state.best.is_none_or(|best| loss < best) {
            state.best = Some(loss);
            run.save_model(name, kept)?;
        }
        if average.is_some() {
            run.save_model(&files.ema, kept)?;
        }
        state.epochs_done = epoch + 1;
        let line = EpochMetrics {
            epoch: epoch + 1,
            step: state.step,
            learning_rate: rate,
            train: training.by_name(),
            validation_loss: loss,
            validation: validation.by_name(),
        };
        files.save(&model, &optimizer, &line, &state)?;
    }
    run.load_model(name, model)
}

/// The files of one training in a run folder.
struct Files<'a> {
    run: &'a RunFolder,
    /// Weights after the last complete epoch.
    last: String,
    /// Average of the weights after the last complete epoch.
    ema: String,
    optimizer: String,
    state: String,
    metrics: String,
}

impl<'a> Files<'a> {
    fn of(name: &str, run: &'a RunFolder) -> Self {
        Self {
            run,
            last: format!("{name}-last"),
            ema: format!("{name}-ema"),
            optimizer: format!("{name}-optimizer"),
            state: format!("{name}-state.json"),
            metrics: format!("{name}.jsonl"),
        }
    }

    /// Where training starts: as given, or where an interrupted run stopped.
    fn start<M: Module>(
        &self,
        mut model: M,
        mut optimizer: ModuleOptimizer,
        resume: bool,
    ) -> Result<(M, ModuleOptimizer, State), RunError> {
        let mut state = State::default();
        if resume && self.run.file(&self.state).exists() {
            state = self.run.load_json(&self.state)?;
            model = self.run.load_model(&self.last, model)?;
            optimizer = self.run.load_optimizer(&self.optimizer, optimizer)?;
        }
        self.run.retain_lines(&self.metrics, |line| {
            line["epoch"].as_u64() <= Some(state.epochs_done as u64)
        })?;
        Ok((model, optimizer, state))
    }

    /// The average of the weights after so many steps; none if none is kept.
    fn ema<M: Module>(&self, model: &M, decay: f64, steps: usize) -> Result<Option<Ema>, RunError> {
        if decay <= 0.0 {
            return Ok(None);
        }
        let average = match steps {
            0 => model.clone(),
            _ => self.run.load_model(&self.ema, model.clone())?,
        };
        Ok(Some(Ema::new(&average, decay, steps)))
    }

    /// Saves all that a resumed run starts from; the state last, which says that the rest is whole.
    fn save<M: Module>(
        &self,
        model: &M,
        optimizer: &ModuleOptimizer,
        line: &EpochMetrics,
        state: &State,
    ) -> Result<(), RunError> {
        self.run.save_model(&self.last, model)?;
        self.run.save_optimizer(&self.optimizer, optimizer)?;
        self.run.append(&self.metrics, line)?;
        self.run.save_json(&self.state, state)
    }
}

#[cfg(test)]
mod tests;
