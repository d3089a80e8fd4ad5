//! Errors of reading and writing checkpoints.

use std::path::PathBuf;

use thiserror::Error;

use super::{POSITION, POSITION_AGAIN};

/// Why a checkpoint of the reference cannot be read or written.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum CheckpointError {
    #[error("{path}: expected a name that ends in .pth, .pt or .safetensors")]
    Format { path: PathBuf },
    #[error(
        "{path}: expected a checkpoint of the reference's trainer (model_info, model_state_dict) or its \
         tensors as safetensors, found: {reason}"
    )]
    Unreadable { path: PathBuf, reason: String },
    #[error("{path}: cannot be written: {reason}")]
    Unwritable { path: PathBuf, reason: String },
    #[error(
        "{path}: these tensors are missing: {}; a model of fewer layers, or not one of the reference's? \
         Set [teacher] in the preset to the checkpoint's dimensions", names.join(", ")
    )]
    Missing { path: PathBuf, names: Vec<String> },
    #[error(
        "{path}: the teacher does not have these tensors: {}; a model of more layers, or one with \
         adapters (LoRA)? Set [teacher] in the preset to the checkpoint's dimensions, and merge adapters first",
        names.join(", ")
    )]
    Unknown { path: PathBuf, names: Vec<String> },
    #[error(
        "{path}: {name} has shape {found:?}, expected {expected:?}; set classes, and patch, d_model and \
         feed_forward of [teacher], in the preset to the checkpoint's"
    )]
    Shape {
        path: PathBuf,
        name: String,
        expected: Vec<usize>,
        found: Vec<usize>,
    },
    #[error(
        "{path}: {POSITION} and {POSITION_AGAIN} differ, expected one encoding under two names; train the \
         reference with a shared positional encoding, as the paper's models were"
    )]
    Positions { path: PathBuf },
}
