//! What can go wrong between a teacher and a checkpoint.

use std::path::PathBuf;

use thiserror::Error;

use super::{POSITION, POSITION_AGAIN};

/// What can go wrong between a teacher and a checkpoint of the reference.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file's name says neither format.
    #[error("{path}: expected a name that ends in .pth, .pt or .safetensors")]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be read as what its name says.
    #[error(
        "{path}: expected a checkpoint of the reference's trainer (model_info, model_state_dict) or its \
         tensors as safetensors, found: {reason}"
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the reader says.
        reason: String,
    },
    /// The file cannot be written.
    #[error("{path}: cannot be written: {reason}")]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the writer says.
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
        /// Names that the reference gives them.
        names: Vec<String>,
    },
    /// The file has tensors that the teacher has no place for.
    #[error(
        "{path}: the teacher has no place for these tensors: {}; a model of more layers, or one with \
         adapters (LoRA)? Set [teacher] in the preset to the checkpoint's dimensions, and merge adapters first",
        names.join(", ")
    )]
    Unknown {
        /// The file.
        path: PathBuf,
        /// Their names in the file.
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
        /// Name that the reference gives it.
        name: String,
        /// Shape in a checkpoint of this teacher.
        expected: Vec<usize>,
        /// Shape in the file.
        found: Vec<usize>,
    },
    /// EMG and intents have positional encodings of their own.
    #[error(
        "{path}: {POSITION} and {POSITION_AGAIN} differ, expected one encoding under two names; train the \
         reference with a shared positional encoding, as the paper's models were"
    )]
    Positions {
        /// The file.
        path: PathBuf,
    },
}
