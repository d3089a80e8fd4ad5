//! The folder of a run: its configuration, checkpoints, models and results.
//!
//! A file is whole or not there, says what it was made from, and is refused where that is not what it is read for.
//! docs/runs.md lists the files.

use std::fs::{self, File};
use std::io::{BufReader, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use burn::module::Module;
use burn::store::ModuleRecord;
use burn::tensor::Bytes;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

mod artefact;
mod durable;
mod error;
#[cfg(test)]
pub(crate) mod kill;
mod lock;

pub(crate) use artefact::Artefact;
pub use durable::write_whole;
pub use error::RunError;

use crate::execution::fingerprint::Fingerprint;
use crate::execution::revision::revision;
use lock::Lock;

/// Ending of a checkpoint's name.
const CHECKPOINT: &str = ".checkpoint";
/// Ending of the name of a file with a line of metrics an epoch.
const METRICS: &str = ".jsonl";
/// The part of an artefact that holds a model's weights.
const WEIGHTS: &str = "weights";

/// The folder of one run.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Held by those that write into the folder.
    lock: Option<Arc<Lock>>,
}

/// A JSON file of a run: its content, what that was made from, and by which revision of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stamped<T> {
    /// Fingerprint of what the content was made from.
    pub made_from: Fingerprint,
    /// Source revision of the program that wrote it, if known.
    #[serde(default)]
    pub revision: Option<String>,
    /// The content.
    #[serde(flatten)]
    pub content: T,
}

/// What an artefact of a single model says of it.
#[derive(Serialize, Deserialize)]
struct Model {
    /// Fingerprint of its weights.
    weights: Fingerprint,
}

/// File name of the weights of a model called `name`.
#[must_use]
pub fn weights_file(name: &str) -> String {
    format!("{name}.bpk")
}

impl RunFolder {
    /// Opens the folder to write into it, and creates it if there is none. Until the last clone is dropped, no other
    /// process can do so.
    ///
    /// # Errors
    /// When another process has the folder open, or it cannot be created.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, RunError> {
        let path = path.into();
        fs::create_dir_all(&path).map_err(|source| RunError::io(&path, source))?;
        Self { path, lock: None }.locked()
    }

    /// Opens the folder of an earlier command to read. Every file in it is whole at any time, so that needs no lock.
    ///
    /// # Errors
    /// When there is none.
    pub fn existing(path: impl Into<PathBuf>) -> Result<Self, RunError> {
        let path = path.into();
        fs::metadata(&path).map_err(|source| RunError::io(&path, source))?;
        Ok(Self { path, lock: None })
    }

    /// The same folder, opened to write into it.
    ///
    /// # Errors
    /// When another process has it open.
    pub fn locked(mut self) -> Result<Self, RunError> {
        if self.lock.is_none() {
            self.lock = Some(Arc::new(Lock::of(&self.path)?));
            durable::remove_partial(&self.path)
                .map_err(|source| RunError::io(&self.path, source))?;
        }
        Ok(self)
    }

    /// The folder's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file in the folder.
    #[must_use]
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The error that an interrupted run returns.
    #[must_use]
    pub(crate) fn interrupted(&self) -> RunError {
        RunError::Interrupted {
            path: self.path.clone(),
        }
    }

    /// Removes files of an earlier run in this folder, if they exist.
    ///
    /// # Errors
    /// When a file cannot be removed.
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
    ///
    /// # Errors
    /// When a file cannot be removed.
    pub(crate) fn remove_checkpoints(&self) -> Result<(), RunError> {
        durable::remove_ending(&self.path, &[CHECKPOINT, METRICS])
            .map_err(|source| RunError::io(&self.path, source))
    }

    /// Path of the checkpoint of a training.
    #[must_use]
    pub(crate) fn checkpoint_path(&self, name: &str) -> PathBuf {
        self.file(&format!("{name}{CHECKPOINT}"))
    }

    /// Path of a training's metrics, a line of JSON an epoch.
    #[must_use]
    pub(crate) fn metrics_path(&self, name: &str) -> PathBuf {
        self.file(&format!("{name}{METRICS}"))
    }

    /// Path of the weights called `name`.
    #[must_use]
    pub(crate) fn weights_path(&self, name: &str) -> PathBuf {
        self.file(&weights_file(name))
    }

    /// Lines of a metrics file; none if there is no such file.
    ///
    /// # Errors
    /// When a line has unexpected content.
    pub(crate) fn lines<T: DeserializeOwned>(&self, name: &str) -> Result<Vec<T>, RunError> {
        let path = self.file(name);
        let Ok(text) = fs::read_to_string(&path) else {
            return Ok(Vec::new());
        };
        text.lines()
            .map(|line| serde_json::from_str(line).map_err(|error| RunError::content(&path, error)))
            .collect()
    }

    /// Writes a JSON file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn save_json(&self, name: &str, value: &impl Serialize) -> Result<(), RunError> {
        let path = self.file(name);
        let json =
            serde_json::to_string_pretty(value).map_err(|error| RunError::content(&path, error))?;
        write_whole(&path, json.as_bytes())
    }

    /// Reads a JSON file.
    ///
    /// # Errors
    /// When the file is missing or has unexpected content.
    pub fn load_json<T: DeserializeOwned>(&self, name: &str) -> Result<T, RunError> {
        let path = self.file(name);
        let file = File::open(&path).map_err(|source| RunError::io(&path, source))?;
        serde_json::from_reader(BufReader::new(file))
            .map_err(|error| RunError::content(&path, error))
    }

    /// Writes a JSON file that says what it was made from.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn save_stamped(
        &self,
        name: &str,
        made_from: Fingerprint,
        content: &impl Serialize,
    ) -> Result<(), RunError> {
        let stamped = Stamped {
            made_from,
            revision: revision().map(str::to_owned),
            content,
        };
        self.save_json(name, &stamped)
    }

    /// Reads a JSON file that was made from this.
    ///
    /// # Errors
    /// [`RunError::NotOfThisRun`] if it was made from something else; when it is missing or has unexpected content.
    pub fn load_stamped<T: DeserializeOwned>(
        &self,
        name: &str,
        made_from: Fingerprint,
    ) -> Result<Stamped<T>, RunError> {
        let stamped: Stamped<T> = self.load_json(name)?;
        if stamped.made_from == made_from {
            Ok(stamped)
        } else {
            let path = self.file(name);
            Err(RunError::NotOfThisRun { path })
        }
    }

    /// Writes a binary file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn save_artefact(&self, path: &Path, artefact: &Artefact) -> Result<(), RunError> {
        let bytes = artefact
            .encode()
            .map_err(|error| RunError::content(path, error))?;
        write_whole(path, &bytes)
    }

    /// Reads a binary file, whatever it was made from.
    ///
    /// # Errors
    /// When the file is missing or damaged.
    pub(crate) fn load_artefact(&self, path: &Path) -> Result<Artefact, RunError> {
        let bytes = fs::read(path).map_err(|source| RunError::io(path, source))?;
        Artefact::decode(&bytes).map_err(|reason| RunError::content(path, reason))
    }

    /// Writes a model's weights as `NAME.bpk`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn save_model(
        &self,
        name: &str,
        made_from: Fingerprint,
        model: &impl Module,
    ) -> Result<(), RunError> {
        let path = self.weights_path(name);
        let about = Model {
            weights: Fingerprint::of_weights(model),
        };
        let artefact = Artefact::new(made_from, &about)
            .map_err(|error| RunError::content(&path, error))?
            .with(WEIGHTS, model_bytes(&path, model)?);
        self.save_artefact(&path, &artefact)
    }

    /// Reads weights that were made from this into a model of the same shape.
    ///
    /// # Errors
    /// [`RunError::NotOfThisRun`] if they were made from something else; when the file is missing, damaged or of
    /// another shape.
    pub fn load_model<M: Module>(
        &self,
        name: &str,
        made_from: Fingerprint,
        model: M,
    ) -> Result<M, RunError> {
        let path = self.weights_path(name);
        let mut artefact = self.own(&path, made_from)?;
        let bytes = artefact.take(WEIGHTS);
        let bytes = bytes.map_err(|reason| RunError::content(&path, reason))?;
        load_model_bytes(&path, bytes, model)
    }

    /// Fingerprint of weights that were made from this.
    ///
    /// # Errors
    /// As [`RunFolder::load_model`].
    pub(crate) fn weights_fingerprint(
        &self,
        name: &str,
        made_from: Fingerprint,
    ) -> Result<Fingerprint, RunError> {
        let path = self.weights_path(name);
        let about: Result<Model, _> = self.own(&path, made_from)?.about();
        Ok(about
            .map_err(|reason| RunError::content(&path, reason))?
            .weights)
    }

    fn own(&self, path: &Path, made_from: Fingerprint) -> Result<Artefact, RunError> {
        let artefact = self.load_artefact(path)?;
        if artefact.made_from == made_from {
            Ok(artefact)
        } else {
            let path = path.to_owned();
            Err(RunError::NotOfThisRun { path })
        }
    }
}

/// A model's weights as bytes, for the file `path`.
///
/// # Errors
/// When they cannot be written.
pub(crate) fn model_bytes(path: &Path, model: &impl Module) -> Result<Vec<u8>, RunError> {
    let bytes = model.clone().into_record().into_bytes();
    let bytes = bytes.map_err(|error| RunError::content(path, error))?;
    Ok(bytes.to_vec())
}

/// Reads weights from bytes of the file `path` into a model of the same shape.
///
/// # Errors
/// When they are damaged or of another shape.
pub(crate) fn load_model_bytes<M: Module>(
    path: &Path,
    bytes: Vec<u8>,
    model: M,
) -> Result<M, RunError> {
    ModuleRecord::from_bytes(Bytes::from_bytes_vec(bytes))
        .and_then(|record| model.try_load_record(record))
        .map_err(|error| RunError::content(path, error))
}
