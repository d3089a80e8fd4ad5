//! Settings of the training loop, and its learning-rate schedule.

use serde::{Deserialize, Serialize};

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

/// Shape of the learning rate over the steps of a training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LrSchedule {
    /// Linear warm-up over this fraction of the steps, then linear decay to 0.
    WarmUp(f64),
    /// A constant rate.
    Constant,
}

/// Learning rate at every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearningRate {
    peak: f64,
    /// Steps of the warm-up, and steps until the rate is 0; none for a constant rate.
    ramp: Option<(usize, usize)>,
}

impl LearningRate {
    /// A schedule over `total` steps that reaches `peak`.
    ///
    /// With a warm-up, as in the reference, the first step has rate 0, and so do steps beyond `total`.
    pub fn new(peak: f64, lr_schedule: LrSchedule, total: usize) -> Self {
        let ramp = match lr_schedule {
            LrSchedule::WarmUp(share) => Some(((share * total as f64) as usize, total)),
            LrSchedule::Constant => None,
        };
        Self { peak, ramp }
    }

    /// Rate at a step, counted from 0.
    pub fn rate(&self, step: usize) -> f64 {
        let Some((warm_up, total)) = self.ramp else {
            return self.peak;
        };
        if step < warm_up {
            return self.peak * step as f64 / warm_up as f64;
        }
        let left = total.saturating_sub(step) as f64;
        self.peak * left / total.saturating_sub(warm_up).max(1) as f64
    }
}
