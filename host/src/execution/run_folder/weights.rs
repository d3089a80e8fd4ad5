//! Binary files of a run, weights above all.

use std::fs;
use std::path::Path;

use burn::module::Module;
use burn::store::ModuleRecord;
use burn::tensor::Bytes;
use serde::{Deserialize, Serialize};

use super::{Artefact, RunError, RunFolder, write_whole};
use crate::execution::fingerprint::Fingerprint;

/// The part of an artefact that holds a model's weights.
const WEIGHTS: &str = "weights";

/// What an artefact of a single model says of it.
#[derive(Serialize, Deserialize)]
struct Model {
    /// Fingerprint of its weights.
    weights: Fingerprint,
}

impl RunFolder {
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
