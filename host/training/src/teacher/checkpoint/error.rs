//! Errors of reading and writing checkpoints.

use std::path::PathBuf;

use thiserror::Error;

use super::{POSITION, POSITION_AGAIN};

/// Why a checkpoint of the reference cannot be read or written.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file's extension is unknown.
    #[error("{path}: expected a name that ends in .pth, .pt or .safetensors")]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// The file's format is not that of its extension.
    #[error(
        "{path}: expected a checkpoint of the reference's trainer (model_info, model_state_dict) or its \
         tensors as safetensors, found: {reason}"
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Message of the reader.
        reason: String,
    },
    /// The file cannot be written.
    #[error("{path}: cannot be written: {reason}")]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// Message of the writer.
        reason: String,
    },
    /// The file lacks tensors.
    #[error(
        "{path}: these tensors are missing: {}; a model of fewer layers, or not one of the reference's? \
         Set [teacher] in the preset to the checkpoint's dimensions", names.join(", ")
    )]
    Missing {
        /// The file.
        path: PathBuf,
        /// Names of the tensors in the reference.
        names: Vec<String>,
    },
    /// The file has tensors that the teacher does not have.
    #[error(
        "{path}: the teacher does not have these tensors: {}; a model of more layers, or one with \
         adapters (LoRA)? Set [teacher] in the preset to the checkpoint's dimensions, and merge adapters first",
        names.join(", ")
    )]
    Unknown {
        /// The file.
        path: PathBuf,
        /// Names of the tensors in the file.
        names: Vec<String>,
    },
    /// A tensor has another shape.
    #[error(
        "{path}: {name} has shape {found:?}, expected {expected:?}; set classes, and patch, d_model and \
         feed_forward of [teacher], in the preset to the checkpoint's"
    )]
    Shape {
        /// The file.
        path: PathBuf,
        /// Name of the tensor in the reference.
        name: String,
        /// Shape in a checkpoint of this teacher.
        expected: Vec<usize>,
        /// Shape in the file.
        found: Vec<usize>,
    },
    /// EMG and intents have different positional encodings.
    #[error(
        "{path}: {POSITION} and {POSITION_AGAIN} differ, expected one encoding under two names; train the \
         reference with a shared positional encoding, as the paper's models were"
    )]
    Positions {
        /// The file.
        path: PathBuf,
    },
}
