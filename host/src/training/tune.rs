//! Fine-tuning of a small model on few recordings: one pass of steps, no files, no choice of a checkpoint.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::epoch::Epoch;
use super::fit::TrainConfig;
use super::learner::Learner;
use super::optimizer::optimizer;
use super::schedule::LearningRate;
use super::weights::{weights, with_weights};
use crate::execution::interrupt::Interrupt;
use crate::execution::run_folder::RunError;

/// How strongly the weights are held to where they started.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Anchor {
    /// After each step each weight goes back by this times the learning rate, as a share of its way: a penalty on the
    /// squared distance to the start (L2-SP, Li et al., arXiv 1802.01483), decoupled from the gradient as AdamW's decay is.
    pub(crate) pull: f64,
    /// Number of weights, the first ones of the model, that do not change at all.
    pub(crate) frozen: usize,
    /// Share of the way from the start to the tuned weights that is gone (WiSE-FT, Wortsman et al., arXiv 2109.01903).
    pub(crate) share: f64,
}

/// The model after the steps of one epoch; none if the user interrupts.
///
/// # Errors
/// When a loss is infinite or no number.
pub(crate) fn tune<L: Learner>(
    learner: &L,
    model: L::Model,
    config: TrainConfig,
    anchor: Anchor,
    interrupt: &Interrupt,
) -> Result<Option<L::Model>, RunError> {
    let schedule = LearningRate::new(config.learning_rate, config.lr_schedule, learner.steps());
    let epoch = Epoch {
        title: learner.name(),
        number: 1,
        schedule: &schedule,
        interrupt,
    };
    let start = weights(&model);
    let back = |model: L::Model, rate: f64| {
        let share = (rate * anchor.pull).min(1.0) as f32;
        if share <= 0.0 && anchor.frozen == 0 {
            return model;
        }
        let mut now = weights(&model);
        for (at, (own, start)) in now.iter_mut().zip(&start).enumerate() {
            let share = if at < anchor.frozen { 1.0 } else { share };
            *own += (start - *own) * share;
        }
        with_weights(model, &now)
    };
    let mut rng = ChaCha8Rng::seed_from_u64(config.seed);
    let mut optimizer = optimizer(config.weight_decay);
    let done = epoch.take(learner, model, &mut optimizer, 0, &mut rng, back)?;
    Ok(done.map(|trained| {
        let mut now = weights(&trained.model);
        for (own, start) in now.iter_mut().zip(&start) {
            *own = start + (*own - start) * anchor.share as f32;
        }
        with_weights(trained.model, &now)
    }))
}
