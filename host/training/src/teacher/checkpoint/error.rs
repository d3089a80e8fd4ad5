//! Errors of reading and writing checkpoints.

use std::path::PathBuf;

use thiserror::Error;

use super::{POSITION, POSITION_AGAIN};

/// Checkpoint of the reference that cannot be read or written.
#[derive(Debug, Error)]
#[error("{path}: {why}")]
pub struct CheckpointError {
    /// The file.
    pub path: PathBuf,
    /// Fault of the file.
    pub why: Fault,
}

/// Reason why a checkpoint cannot be read or written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Fault {
    #[error("expected a name that ends in .pth, .pt or .safetensors")]
    Format,
    #[error(
        "expected a checkpoint of the reference's trainer (model_info, model_state_dict) or its \
         tensors as safetensors, found: {0}"
    )]
    Unreadable(String),
    #[error("cannot be written: {0}")]
    Unwritable(String),
    #[error(
        "these tensors are missing: {}; a model of fewer layers, or not one of the reference's? \
         Set [teacher] in the preset to the checkpoint's dimensions", .0.join(", ")
    )]
    Missing(Vec<String>),
    #[error(
        "the teacher does not have these tensors: {}; a model of more layers, or one with \
         adapters (LoRA)? Set [teacher] in the preset to the checkpoint's dimensions, and merge adapters first",
        .0.join(", ")
    )]
    Unknown(Vec<String>),
    #[error(
        "{name} has shape {found:?}, expected {expected:?}; set classes, and patch, d_model and \
         feed_forward of [teacher], in the preset to the checkpoint's"
    )]
    Shape {
        name: String,
        expected: Vec<usize>,
        found: Vec<usize>,
    },
    #[error(
        "{POSITION} and {POSITION_AGAIN} differ, expected one encoding under two names; train the \
         reference with a shared positional encoding, as the paper's models were"
    )]
    Positions,
}

impl Fault {
    pub(super) fn unreadable(reason: impl ToString) -> Self {
        Self::Unreadable(reason.to_string())
    }

    pub(super) fn unwritable(reason: impl ToString) -> Self {
        Self::Unwritable(reason.to_string())
    }
}
