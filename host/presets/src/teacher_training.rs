//! Settings of a teacher's training.

use serde::{Deserialize, Serialize};

use super::masking::Task;
use crate::augmentation::Augmentation;
use crate::schedule::LrSchedule;
use crate::teacher::LoraConfig;
use crate::training::TrainConfig;

/// Name of the run's files: `teacher.bpk` is the checkpoint of the lowest validation loss.
pub const NAME: &str = "teacher";
/// Name of the files of a training with LoRA, before the adapters are merged into the teacher.
pub const ADAPTED: &str = "teacher-lora";

/// Settings of a teacher's training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TeacherTraining {
    /// Samples between the starts of two windows.
    pub stride: usize,
    /// Passes over all examples.
    pub epochs: usize,
    /// Examples per step.
    pub batch: usize,
    /// Peak learning rate.
    pub learning_rate: f64,
    /// Schedule of the learning rate: a warm-up for a fresh model, constant for fine-tuning, as in the paper.
    pub lr_schedule: LrSchedule,
    /// Decoupled weight decay, on every parameter.
    pub weight_decay: f32,
    /// Decay of the exponential moving average of the weights that is saved; 0, as in the paper, saves the weights
    /// themselves.
    #[serde(default)]
    pub ema_decay: f64,
    /// Tasks; each window is presented once as each of them.
    pub tasks: Vec<Task>,
    /// Augmentation of the training windows; none in the paper.
    pub augmentation: Option<Augmentation>,
    /// LoRA adapters, which are trained while the weights that training starts from stay as they are; none: no
    /// adapters.
    pub lora: Option<LoraConfig>,
}

impl TeacherTraining {
    /// The settings of the training loop.
    pub fn train_config(&self, seed: u64) -> TrainConfig {
        TrainConfig {
            epochs: self.epochs,
            learning_rate: self.learning_rate,
            lr_schedule: self.lr_schedule,
            weight_decay: self.weight_decay,
            ema_decay: self.ema_decay,
            seed,
        }
    }
}
