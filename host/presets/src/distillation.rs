//! Dimensions of a student, and settings of its training: knowledge distillation from the teacher's logits or from an
//! ensemble of students, and the labels. They do not need the library that trains it, since `tests/fuzz` reads presets
//! too.

use serde::{Deserialize, Serialize};
use shared::model::dimensions::Companding;

use crate::augmentation::Augmentation;
use crate::training::{LrSchedule, TrainConfig};

/// Name of the run's files: `student.bpk` is the checkpoint of the lowest validation loss.
pub const NAME: &str = "student";
/// Names of the files of an ensemble's members.
pub const MEMBERS: [&str; 8] = [
    "member-1", "member-2", "member-3", "member-4", "member-5", "member-6", "member-7", "member-8",
];

/// Dimensions of a student.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudentConfig {
    /// Width of a token; a patch is a token.
    pub d_model: usize,
    /// Attention heads; divides `d_model`.
    pub heads: usize,
    /// Encoder layers.
    pub layers: usize,
    /// Patches that a patch attends to, itself included.
    pub span: usize,
    /// Companding of the input.
    pub companding: Companding,
    /// Whether a board has to have room for it; otherwise only a PC runs it.
    #[serde(default = "yes")]
    pub board: bool,
}

const fn yes() -> bool {
    true
}

impl StudentConfig {
    /// Number of patches that influence an output of the encoder.
    pub(crate) fn receptive_field(&self) -> usize {
        // A preset may hold any integers.
        let before = self.layers.saturating_mul(self.span.saturating_sub(1));
        before.saturating_add(1)
    }
}

/// Settings of a student's training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Distillation {
    /// Epochs; a validation follows each.
    pub epochs: usize,
    /// Steps per epoch.
    pub steps: usize,
    /// Sequences per step.
    pub batch: usize,
    /// Patches per sequence; more than a window has.
    pub patches: usize,
    /// Peak learning rate.
    pub learning_rate: f64,
    /// Fraction of the steps in which the rate rises.
    pub warm_up: f64,
    /// Decoupled weight decay.
    pub weight_decay: f32,
    /// Decay of the exponential moving average of the weights that is saved; 0 saves the weights themselves.
    #[serde(default)]
    pub ema_decay: f64,
    /// Weight of the distillation loss, 0..=1; the loss on the labels has the rest. 0 trains on the labels alone.
    pub teacher_share: f64,
    /// Students that teach in place of the run's teacher, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<EnsembleConfig>,
    /// Temperature of both distributions in the distillation loss.
    pub temperature: f64,
    /// Augmentation of the student's input; the teacher's input is the EMG as recorded, an ensemble's the student's
    /// own.
    pub augmentation: Option<Augmentation>,
}

/// An ensemble of students, each trained on the labels alone from weights and batches of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnsembleConfig {
    /// Number of students.
    pub members: usize,
    /// Epochs of each student.
    pub epochs: usize,
}

impl Distillation {
    /// Whether the student learns from the run's teacher.
    pub fn needs_teacher(&self) -> bool {
        self.teacher_share > 0.0 && self.ensemble.is_none()
    }

    /// The ensemble that the student learns from, if there is one.
    pub fn teaching_ensemble(&self) -> Option<EnsembleConfig> {
        self.ensemble.filter(|_| self.teacher_share > 0.0)
    }

    /// Settings for a student that learns from the labels alone.
    pub(crate) fn on_labels(&self) -> Self {
        Self {
            teacher_share: 0.0,
            ensemble: None,
            ..self.clone()
        }
    }

    /// The settings of the training loop.
    pub fn train_config(&self, seed: u64) -> TrainConfig {
        TrainConfig {
            epochs: self.epochs,
            learning_rate: self.learning_rate,
            lr_schedule: LrSchedule::WarmUp(self.warm_up),
            weight_decay: self.weight_decay,
            ema_decay: self.ema_decay,
            seed,
        }
    }
}
