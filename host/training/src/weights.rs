//! Weights of models, as files of a run folder.

use std::path::Path;

use burn::module::{Module, ModuleVisitor, Param};
use burn::store::ModuleRecord;
use burn::tensor::{Bytes, Tensor};

use execution::fingerprint::Fingerprint;
use execution::run_folder::{Artefact, ModelInfo, RunError, RunFolder};

/// Name of an artefact's part with a model's weights.
const PART: &str = "weights";

/// Weights of models in a run folder.
pub trait Weights {
    /// Writes a model's weights as `NAME.bpk`.
    fn save_model(
        &self,
        name: &str,
        made_from: Fingerprint,
        model: &impl Module,
    ) -> Result<(), RunError>;

    /// Reads the weights made from `made_from` into a model of the same shape.
    fn load_model<M: Module>(
        &self,
        name: &str,
        made_from: Fingerprint,
        model: M,
    ) -> Result<M, RunError>;
}

impl Weights for RunFolder {
    fn save_model(
        &self,
        name: &str,
        made_from: Fingerprint,
        model: &impl Module,
    ) -> Result<(), RunError> {
        let path = self.weights_path(name);
        let about = ModelInfo {
            weights: fingerprint(model),
        };
        let artefact = Artefact::new(made_from, &about)
            .map_err(|error| RunError::content(&path, error))?
            .with(PART, model_bytes(&path, model)?);
        self.save_artefact(&path, &artefact)
    }

    fn load_model<M: Module>(
        &self,
        name: &str,
        made_from: Fingerprint,
        model: M,
    ) -> Result<M, RunError> {
        let path = self.weights_path(name);
        let mut artefact = self.artefact_of(&path, made_from)?;
        let bytes = artefact.take(PART);
        let bytes = bytes.map_err(|reason| RunError::content(&path, reason))?;
        load_model_bytes(&path, bytes, model)
    }
}

/// Fingerprint of the values of a model's weights, in the order in which the module visits them. A file's bytes would not
/// do: they also hold identifiers that are drawn anew for every model.
pub(crate) fn fingerprint(model: &impl Module) -> Fingerprint {
    Fingerprint::of_parts(|update| model.visit(&mut Values(update)))
}

struct Values<'a>(&'a mut dyn FnMut(&[u8]));

impl ModuleVisitor for Values<'_> {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        for value in param.val().into_data().iter::<f32>() {
            (self.0)(&value.to_le_bytes());
        }
    }
}

/// Encodes a model's weights as bytes, for the file `path`.
pub(crate) fn model_bytes(path: &Path, model: &impl Module) -> Result<Vec<u8>, RunError> {
    let bytes = model.clone().into_record().into_bytes();
    let bytes = bytes.map_err(|error| RunError::content(path, error))?;
    Ok(bytes.to_vec())
}

/// Reads weights from bytes of the file `path` into a model of the same shape.
pub(crate) fn load_model_bytes<M: Module>(
    path: &Path,
    bytes: Vec<u8>,
    model: M,
) -> Result<M, RunError> {
    ModuleRecord::from_bytes(Bytes::from_bytes_vec(bytes))
        .and_then(|record| model.try_load_record(record))
        .map_err(|error| RunError::content(path, error))
}
