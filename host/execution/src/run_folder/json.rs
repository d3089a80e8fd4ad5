//! JSON files of a run.

use std::fs::{self, File};
use std::io::BufReader;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{RunError, RunFolder, write_whole};
use crate::fingerprint::Fingerprint;
use crate::revision::revision;

/// A JSON file of a run: its content, what that was made from, and by which revision of the program.
#[derive(Serialize, Deserialize)]
struct Stamped<T> {
    made_from: Fingerprint,
    /// Source revision of the program that wrote it, if known.
    #[serde(default)]
    revision: Option<String>,
    #[serde(flatten)]
    content: T,
}

impl RunFolder {
    /// Lines of a metrics file; none if there is no such file.
    pub fn lines<T: DeserializeOwned>(&self, name: &str) -> Result<Vec<T>, RunError> {
        let path = self.file(name);
        let Ok(text) = fs::read_to_string(&path) else {
            return Ok(Vec::new());
        };
        text.lines()
            .map(|line| serde_json::from_str(line).map_err(|error| RunError::content(&path, error)))
            .collect()
    }

    /// Writes a JSON file.
    pub fn save_json(&self, name: &str, value: &impl Serialize) -> Result<(), RunError> {
        let path = self.file(name);
        let json =
            serde_json::to_string_pretty(value).map_err(|error| RunError::content(&path, error))?;
        write_whole(&path, json.as_bytes())
    }

    /// Reads a JSON file.
    pub fn load_json<T: DeserializeOwned>(&self, name: &str) -> Result<T, RunError> {
        let path = self.file(name);
        let file = File::open(&path).map_err(|source| RunError::io(&path, source))?;
        serde_json::from_reader(BufReader::new(file))
            .map_err(|error| RunError::content(&path, error))
    }

    /// Writes a JSON file that says what it was made from.
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

    /// Reads a JSON file that was made from `made_from`.
    ///
    /// # Errors
    /// [`RunError::NotOfThisRun`] if it was made from something else; when it is missing or has unexpected content.
    pub fn load_stamped<T: DeserializeOwned>(
        &self,
        name: &str,
        made_from: Fingerprint,
    ) -> Result<T, RunError> {
        let stamped: Stamped<T> = self.load_json(name)?;
        if stamped.made_from == made_from {
            Ok(stamped.content)
        } else {
            let path = self.file(name);
            Err(RunError::NotOfThisRun { path })
        }
    }
}

/// Metrics of an epoch: a line of a training's `NAME.jsonl`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EpochMetrics {
    /// Epoch, from 1 on.
    pub epoch: usize,
    /// Optimizer steps so far.
    pub step: usize,
    /// Learning rate of the epoch's last step.
    pub learning_rate: f64,
    /// Metrics of training, means over the epoch.
    pub train: Vec<(String, f64)>,
    /// The loss that selects the checkpoint.
    pub validation_loss: f64,
    /// Metrics of validation.
    pub validation: Vec<(String, f64)>,
}
