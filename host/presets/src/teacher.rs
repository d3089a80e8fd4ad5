//! Dimensions of a teacher and of its adapters, and settings of its training. They do not need the library that trains
//! it, since `tests/fuzz` reads presets too.

use serde::{Deserialize, Serialize};
use shared::model::dimensions::Companding;

use super::masking::Task;
use crate::augmentation::Augmentation;
use crate::training::{LrSchedule, TrainConfig};

/// Name of the run's files: `teacher.bpk` is the checkpoint of the lowest validation loss.
pub const NAME: &str = "teacher";
/// Name of the files of a training with LoRA, before the adapters are merged into the teacher.
pub const ADAPTED: &str = "teacher-lora";

/// Dimensions of a teacher.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TeacherConfig {
    /// Samples in a window: 600 in the paper; 100 and 300 in its ablation.
    pub window: usize,
    /// Samples in a token: 1 in the paper, 20 in the presets for a CPU. Divides the window.
    pub patch: usize,
    /// Companding of the encoder's input; the target of the reconstruction stays linear.
    pub companding: Companding,
    /// Width of a token.
    pub d_model: usize,
    /// Attention heads; divides `d_model`.
    pub heads: usize,
    /// Encoder layers.
    pub layers: usize,
    /// Hidden width of the feed-forward blocks.
    pub feed_forward: usize,
    /// Dropout in the feed-forward blocks and after attention.
    pub dropout: f64,
    /// Dropout of the attention weights; the paper uses the same number for both.
    pub attention_dropout: f64,
}

/// LoRA of the feed-forward blocks and of the intent head, the layers that the reference adapts.
///
/// The reference's defaults are rank 16, alpha 8 and a dropout of 0.05 in the adapters; there is no
/// dropout here.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoraConfig {
    /// Rank of an adapter.
    pub rank: usize,
    /// Adapters are scaled by `alpha / rank`.
    pub alpha: f64,
}

impl TeacherConfig {
    /// Samples of a window, and how they are grouped into tokens.
    pub const fn window_shape(&self) -> WindowShape {
        WindowShape {
            window: self.window,
            patch: self.patch,
        }
    }
}

/// Samples of a window, and how they are grouped into tokens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowShape {
    /// Samples of a window, a multiple of the patch; 600 in the paper.
    pub window: usize,
    /// Samples of a token; 1 in the paper.
    pub patch: usize,
}

impl WindowShape {
    /// Tokens of one modality.
    pub const fn tokens(self) -> usize {
        self.window / self.patch
    }
}

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
