//! Dimensions of a student, as a preset has them. They do not need the library that trains it, since `tests/fuzz` reads
//! presets too.

use serde::{Deserialize, Serialize};
use shared::model::dimensions::Companding;

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
    #[must_use]
    pub(crate) fn receptive_field(&self) -> usize {
        // A preset may hold any integers.
        let before = self.layers.saturating_mul(self.span.saturating_sub(1));
        before.saturating_add(1)
    }
}
