//! The folder of a run: its configuration, checkpoints, models and results.
//!
//! Every file is complete or absent, and says what it was made from. A file that was made from something else than
//! expected is refused. docs/runs.md lists the files.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

mod artefact;
mod durable;
mod error;
mod json;
mod lock;

pub use artefact::{Artefact, ModelInfo};
#[cfg(any(test, feature = "testing"))]
pub use durable::kill;
pub use durable::write_whole;
pub use error::RunError;
pub use json::EpochMetrics;
use lock::Lock;

const CHECKPOINT: &str = ".checkpoint";
const WEIGHTS: &str = ".bpk";
/// Ending of the name of a file with a line of metrics an epoch.
const METRICS: &str = ".jsonl";

/// Endings of the names of files that a run makes and that may be worth keeping. A configuration alone is left by a run
/// that was refused before its training, and is made again.
const OF_A_RUN: [&str; 6] = [
    WEIGHTS,
    CHECKPOINT,
    ".intent",
    METRICS,
    "report.html",
    "results.json",
];

/// The folder of one run.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Lock of a folder that is open for writing.
    lock: Option<Arc<Lock>>,
}

impl RunFolder {
    /// Opens the folder to write into it, and creates it if it is missing. Until the last clone is dropped, no other
    /// process can do so.
    ///
    /// # Errors
    /// When another process has the folder open, or it cannot be created.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, RunError> {
        let path = path.into();
        fs::create_dir_all(&path).map_err(|source| RunError::io(&path, source))?;
        Self { path, lock: None }.locked()
    }

    /// Refuses a folder that holds files of a run: a run that begins there would replace them.
    ///
    /// # Errors
    /// [`RunError::Exists`] with the first such file.
    pub fn refuse_run(path: &Path) -> Result<(), RunError> {
        let entries = match fs::read_dir(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            entries => entries.map_err(|source| RunError::io(path, source))?,
        };
        let mut names = Vec::new();
        for entry in entries {
            let entry = entry.map_err(|source| RunError::io(path, source))?;
            names.push(entry.file_name().to_string_lossy().into_owned());
        }
        names.sort();
        let is_run = |name: &String| OF_A_RUN.iter().any(|ending| name.ends_with(ending));
        match names.into_iter().find(is_run) {
            Some(found) => Err(RunError::Exists {
                path: path.to_owned(),
                found,
            }),
            None => Ok(()),
        }
    }

    /// Opens the folder of an earlier command for reading. No lock is needed, since every file in it is complete at any
    /// time.
    pub fn existing(path: impl Into<PathBuf>) -> Result<Self, RunError> {
        let path = path.into();
        fs::metadata(&path).map_err(|source| RunError::io(&path, source))?;
        Ok(Self { path, lock: None })
    }

    /// Opens the folder for writing too.
    pub fn locked(mut self) -> Result<Self, RunError> {
        if self.lock.is_none() {
            self.lock = Some(Arc::new(Lock::of(&self.path)?));
            durable::remove_ending(&self.path, &[durable::PARTIAL])
                .map_err(|source| RunError::io(&self.path, source))?;
        }
        Ok(self)
    }

    /// The folder's path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The error that an interrupted run returns.
    pub fn interrupted(&self) -> RunError {
        RunError::Interrupted {
            path: self.path.clone(),
        }
    }

    /// Removes files of an earlier run in this folder, if they exist.
    pub fn remove_files(&self, names: &[&str]) -> Result<(), RunError> {
        for name in names {
            let path = self.file(name);
            match fs::remove_file(&path) {
                Err(source) if source.kind() != ErrorKind::NotFound => {
                    return Err(RunError::io(&path, source));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Removes the checkpoints and metrics of every training in the folder: a run that begins must not continue them.
    pub fn remove_checkpoints(&self) -> Result<(), RunError> {
        durable::remove_ending(&self.path, &[CHECKPOINT, METRICS])
            .map_err(|source| RunError::io(&self.path, source))
    }

    /// Path of the checkpoint of a training.
    pub fn checkpoint_path(&self, name: &str) -> PathBuf {
        self.file(&format!("{name}{CHECKPOINT}"))
    }

    /// Path of a training's metrics, a line of JSON an epoch.
    pub fn metrics_path(&self, name: &str) -> PathBuf {
        self.file(&format!("{name}{METRICS}"))
    }

    /// Path of the weights called `name`.
    pub fn weights_path(&self, name: &str) -> PathBuf {
        self.file(&format!("{name}{WEIGHTS}"))
    }
}
