//! Errors of a run folder.

use std::path::PathBuf;

use thiserror::Error;

/// Why a run folder cannot be used.
#[derive(Debug, Error)]
pub enum RunError {
    /// A file cannot be read or written.
    #[error("{path}")]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// A file does not have the expected content.
    #[error(
        "{path}: {reason}; it was written by another version or is damaged, run the step again"
    )]
    Content {
        /// The file.
        path: PathBuf,
        /// The reader's message.
        reason: String,
    },
    /// The run was interrupted; checkpoints up to the last complete epoch are kept.
    #[error("interrupted; continue with the same command and --resume (run folder {path})")]
    Interrupted {
        /// The run's folder.
        path: PathBuf,
    },
}
