//! Settings of the training loop.

use serde::Serialize;

use super::schedule::LrSchedule;

/// Settings of a model's training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
