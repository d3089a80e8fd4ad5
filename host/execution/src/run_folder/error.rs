//! Errors of a run folder.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Error of a run folder, or of a run that cannot go on.
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
    /// A model has not been trained.
    #[error("{path}: not trained yet; `myointent train --run {run} --resume` trains the models of a run", run = .path.parent().unwrap_or(.path).display())]
    NotTrained {
        /// File of the model's weights.
        path: PathBuf,
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
    /// A file was made from something else than what this run would make it from.
    #[error(
        "{path} does not belong to this run: it was made with other settings, people or recordings, or from another teacher or student; run the step that makes it again, or give another run folder"
    )]
    NotOfThisRun {
        /// The file.
        path: PathBuf,
    },
    /// A checkpoint of another training.
    #[error(
        "{path} is a checkpoint of a training with other settings, people or recordings, or from another teacher: give --overwrite in place of --resume to begin anew, or another run folder"
    )]
    OtherTraining {
        /// The checkpoint.
        path: PathBuf,
    },
    /// The configuration to resume with is not that of the run.
    #[error(
        "{path} was begun with another configuration than this command gives ({difference}): give --overwrite in place of --resume to begin anew, or repeat the command that began it"
    )]
    OtherConfiguration {
        /// The run's configuration.
        path: PathBuf,
        /// The first difference.
        difference: String,
    },
    /// The recordings differ from when the run began.
    #[error(
        "the recordings found are not those that the run {path} began with: restore them, or begin a new run"
    )]
    OtherRecordings {
        /// The run's folder.
        path: PathBuf,
    },
    /// The folder of a run that begins holds files of another one.
    #[error(
        "{path} holds a run already ({found}), and a new one would replace it: give another folder with --run; or --resume, to go on with that run; or --overwrite, to begin anew in its place"
    )]
    Exists {
        /// The run's folder.
        path: PathBuf,
        /// A file of the other run.
        found: String,
    },
    /// Another process writes into the folder.
    #[error("{path} is in use by {holder}; wait until it has finished, or give another run folder")]
    Locked {
        /// The run's folder.
        path: PathBuf,
        /// Process, machine and start time, and its command.
        holder: String,
    },
    /// A loss is infinite or no number.
    #[error(
        "epoch {epoch} of {name}: the {what} is {loss}, so the training has diverged; lower its learning rate, and look at the recordings with `myointent data inspect`"
    )]
    Diverged {
        /// Name of the training.
        name: String,
        /// The epoch, from 1 on.
        epoch: usize,
        /// Name of the loss, of training or validation.
        what: String,
        /// The loss.
        loss: f64,
    },
    /// The run was interrupted; all complete steps are kept.
    #[error("interrupted; what was complete is kept in {path}")]
    Interrupted {
        /// The run's folder.
        path: PathBuf,
    },
}

impl RunError {
    /// Error of reading or writing a file.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// Error of a file whose content is not as expected.
    pub fn content(path: &Path, reason: impl ToString) -> Self {
        Self::Content {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }

    /// Whether the user interrupted.
    pub const fn is_interrupt(&self) -> bool {
        matches!(self, Self::Interrupted { .. })
    }
}
