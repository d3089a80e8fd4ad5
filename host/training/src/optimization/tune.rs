//! Fine-tuning of a small model on few recordings: one pass of steps, without files and without choosing a checkpoint.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::epoch::{Epoch, Start};
use super::fit::TrainConfig;
use super::learner::Learner;
use super::optimizer::optimizer;
use execution::interrupt::Interrupt;
use execution::run_folder::RunError;
use presets::training::LearningRate;

/// Trains a model for one epoch; none if the user interrupts. `report` gets the number of steps done.
pub(crate) fn tune<L: Learner>(
    learner: &L,
    model: L::Model,
    config: TrainConfig,
    interrupt: &Interrupt,
    mut report: impl FnMut(usize),
) -> Result<Option<L::Model>, RunError> {
    let schedule = LearningRate::new(config.learning_rate, config.lr_schedule, learner.steps());
    let epoch = Epoch {
        title: learner.name(),
        number: 1,
        first_step: 0,
        schedule: &schedule,
        interrupt,
    };
    let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
    let mut optimizer = optimizer(config.weight_decay);
    let start = Start::default();
    let done = epoch.take(learner, model, &mut optimizer, &mut rng, start, |taken| {
        report(taken.steps);
        Ok(())
    })?;
    Ok(done.map(|trained| trained.model))
}
