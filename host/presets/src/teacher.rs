//! Dimensions of a teacher and of its adapters, as a preset has them. They do not need the library that trains it,
//! since `tests/fuzz` reads presets too.

use serde::{Deserialize, Serialize};
use shared::model::dimensions::Companding;

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
    #[must_use]
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
    #[must_use]
    pub const fn tokens(self) -> usize {
        self.window / self.patch
    }
}
