//! Errors of a run folder.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Error of a run folder, or of a run that cannot go on.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum RunError {
    #[error("{path}")]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{path}: not trained yet; `myointent train --run {run} --resume` trains the models of a run", run = .path.parent().unwrap_or(.path).display())]
    NotTrained { path: PathBuf },
    #[error(
        "{path}: {reason}; it was written by another version or is damaged, run the step again"
    )]
    Content { path: PathBuf, reason: String },
    #[error(
        "{path} does not belong to this run: it was made with other settings, people or recordings, or from another teacher or student; run the step that makes it again, or give another run folder"
    )]
    NotOfThisRun { path: PathBuf },
    #[error(
        "{path} is a checkpoint of a training with other settings, people or recordings, or from another teacher: give --overwrite in place of --resume to begin anew, or another run folder"
    )]
    OtherTraining { path: PathBuf },
    #[error(
        "{path} was begun with another configuration than this command gives ({difference}): give --overwrite in place of --resume to begin anew, or repeat the command that began it"
    )]
    OtherConfiguration { path: PathBuf, difference: String },
    #[error(
        "the recordings found are not those that the run {path} began with: restore them, or begin a new run"
    )]
    OtherRecordings { path: PathBuf },
    #[error(
        "{path} holds a run already ({found}), and a new one would replace it: give another folder with --run; or --resume, to go on with that run; or --overwrite, to begin anew in its place"
    )]
    Exists { path: PathBuf, found: String },
    #[error("{path} is in use by {holder}; wait until it has finished, or give another run folder")]
    Locked { path: PathBuf, holder: String },
    #[error(
        "epoch {epoch} of {name}: the {what} is {loss}, so the training has diverged; lower its learning rate, and look at the recordings with `myointent data inspect`"
    )]
    Diverged {
        name: String,
        epoch: usize,
        what: String,
        loss: f64,
    },
    #[error("interrupted; what was complete is kept in {path}")]
    Interrupted { path: PathBuf },
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
