//! Fine-tuning of a small model on few recordings: one pass of steps, without files and without choosing a checkpoint.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::checkpoint::Checkpoint;
use super::epoch::Epoch;
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
        schedule: &schedule,
        rng: ChaCha8Rng::seed_from_u64(config.seed),
        interrupt,
    };
    let start = Checkpoint::new(model, optimizer(config.weight_decay));
    let done = epoch.take(learner, start, |training| {
        report(training.progress.within.as_ref().map_or(0, |own| own.steps));
        Ok(())
    })?;
    Ok(done.map(|training| training.model))
}
