//! The folder of a run: its configuration, metrics as JSON lines, checkpoints.
//!
//! Every file is written under a temporary name and renamed when complete, so an interrupted run leaves
//! the last complete checkpoint.

use std::fs::{self, File, OpenOptions};
use std::io::{BufReader, Write as _};
use std::path::{Path, PathBuf};

use burn::module::Module;
use burn::optim::ModuleOptimizer;
use burn::store::ModuleRecord;
use serde::Serialize;
use serde::de::DeserializeOwned;

mod error;
#[cfg(test)]
pub(crate) mod kill;

pub use error::RunError;

/// The folder of one run.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
}

/// File name of the weights of a model called `name`.
#[must_use]
pub fn weights_file(name: &str) -> String {
    format!("{name}.bpk")
}

impl RunFolder {
    /// Opens the folder, and creates it if there is none.
    ///
    /// # Errors
    /// When the folder cannot be created.
    pub fn open(path: impl Into<PathBuf>) -> Result<Self, RunError> {
        let path = path.into();
        fs::create_dir_all(&path).map_err(|source| RunError::Io {
            path: path.clone(),
            source,
        })?;
        Ok(Self { path })
    }

    /// Opens the folder of an earlier command.
    ///
    /// # Errors
    /// When there is none.
    pub fn existing(path: impl Into<PathBuf>) -> Result<Self, RunError> {
        let path = path.into();
        fs::metadata(&path).map_err(|source| RunError::Io {
            path: path.clone(),
            source,
        })?;
        Ok(Self { path })
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
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(RunError::Io { path, source });
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Appends one JSON line to a metrics file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn append(&self, name: &str, line: &impl Serialize) -> Result<(), RunError> {
        let path = self.file(name);
        let io = |source| RunError::Io {
            path: path.clone(),
            source,
        };
        let json = serde_json::to_string(line).map_err(|error| RunError::Content {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .map_err(io)?;
        writeln!(file, "{json}").map_err(io)?;
        #[cfg(test)]
        kill::point();
        Ok(())
    }

    /// Keeps the lines of a metrics file that `keep` accepts: a resumed run writes those after its checkpoint again.
    ///
    /// # Errors
    /// When the file cannot be read or written.
    pub(crate) fn retain_lines(
        &self,
        name: &str,
        keep: impl Fn(&serde_json::Value) -> bool,
    ) -> Result<(), RunError> {
        let path = self.file(name);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
            Err(source) => return Err(RunError::Io { path, source }),
        };
        let kept: String = text
            .lines()
            .filter(|line| serde_json::from_str(line).is_ok_and(|value| keep(&value)))
            .flat_map(|line| [line, "\n"])
            .collect();
        write_whole(&path, kept.as_bytes())
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
            .map(|line| {
                serde_json::from_str(line).map_err(|error| RunError::Content {
                    path: path.clone(),
                    reason: error.to_string(),
                })
            })
            .collect()
    }

    /// Writes a JSON file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn save_json(&self, name: &str, value: &impl Serialize) -> Result<(), RunError> {
        let path = self.file(name);
        let json = serde_json::to_string_pretty(value).map_err(|error| RunError::Content {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        write_whole(&path, json.as_bytes())
    }

    /// Reads a JSON file.
    ///
    /// # Errors
    /// When the file is missing or has unexpected content.
    pub fn load_json<T: DeserializeOwned>(&self, name: &str) -> Result<T, RunError> {
        let path = self.file(name);
        let file = File::open(&path).map_err(|source| RunError::Io {
            path: path.clone(),
            source,
        })?;
        serde_json::from_reader(BufReader::new(file)).map_err(|error| RunError::Content {
            path,
            reason: error.to_string(),
        })
    }

    /// Path of the weights or of the optimizer's state called `name`.
    #[must_use]
    pub(crate) fn weights_path(&self, name: &str) -> PathBuf {
        self.file(&weights_file(name))
    }

    /// Writes a model's weights as `NAME.bpk`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn save_model(&self, name: &str, model: &impl Module) -> Result<(), RunError> {
        let path = self.weights_path(name);
        let bytes =
            model
                .clone()
                .into_record()
                .into_bytes()
                .map_err(|error| RunError::Content {
                    path: path.clone(),
                    reason: error.to_string(),
                })?;
        write_whole(&path, &bytes)
    }

    /// Reads weights into a model of the same shape.
    ///
    /// # Errors
    /// When the file is missing, damaged or of another shape.
    pub fn load_model<M: Module>(&self, name: &str, model: M) -> Result<M, RunError> {
        let path = self.weights_path(name);
        let content = |reason: String| RunError::Content {
            path: path.clone(),
            reason,
        };
        File::open(&path).map_err(|source| RunError::Io {
            path: path.clone(),
            source,
        })?;
        let record = ModuleRecord::load(&path).map_err(|error| content(error.to_string()))?;
        model
            .try_load_record(record)
            .map_err(|error| content(error.to_string()))
    }

    /// Writes an optimizer's state.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn save_optimizer(
        &self,
        name: &str,
        optimizer: &ModuleOptimizer,
    ) -> Result<(), RunError> {
        let path = self.weights_path(name);
        let bytes = optimizer.into_bytes().map_err(|error| RunError::Content {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        write_whole(&path, &bytes)
    }

    /// Reads an optimizer's state.
    ///
    /// # Errors
    /// When the file is missing or damaged.
    pub(crate) fn load_optimizer(
        &self,
        name: &str,
        optimizer: ModuleOptimizer,
    ) -> Result<ModuleOptimizer, RunError> {
        let path = self.weights_path(name);
        optimizer.load(&path).map_err(|error| RunError::Content {
            path,
            reason: error.to_string(),
        })
    }
}

/// Writes a file under a temporary name and renames it when complete.
///
/// # Errors
/// When the file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let io = |source| RunError::Io {
        path: path.to_owned(),
        source,
    };
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    #[cfg(test)]
    {
        fs::write(&partial, &bytes[..bytes.len() / 2]).map_err(io)?;
        kill::point();
    }
    fs::write(&partial, bytes).map_err(io)?;
    #[cfg(test)]
    kill::point();
    fs::rename(&partial, path).map_err(io)?;
    #[cfg(test)]
    kill::point();
    Ok(())
}
