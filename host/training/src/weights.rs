//! Weights of models, as files of a run folder.

use std::path::Path;

use burn::module::{Module, ModuleVisitor, Param};
use burn::store::ModuleRecord;
use burn::tensor::{Bytes, Tensor};

use execution::fingerprint::Fingerprint;
use execution::run_folder::{Artefact, ModelInfo, RunError, RunFolder};

/// Name of an artefact's part with a model's weights.
const PART: &str = "weights";

/// Writes a model's weights into a run folder as `NAME.bpk`.
pub(crate) fn save_model(
    run: &RunFolder,
    name: &str,
    made_from: Fingerprint,
    model: &impl Module,
) -> Result<(), RunError> {
    let path = run.weights_path(name);
    let weights = model_bytes(&path, model)?;
    let about = ModelInfo {
        weights: fingerprint(model),
    };
    Artefact::new(path, made_from, &about)?
        .with(PART, weights)
        .save()
}

/// Reads the weights of a run folder made from `made_from` into a model of the same shape.
pub fn load_model<M: Module>(
    run: &RunFolder,
    name: &str,
    made_from: Fingerprint,
    model: M,
) -> Result<M, RunError> {
    let path = run.weights_path(name);
    let bytes = run.artefact_of(&path, made_from)?.take(PART)?;
    load_model_bytes(&path, bytes, model)
}

/// Values of a model's weights, in the order in which the module visits them.
pub(crate) fn values(model: &impl Module) -> Vec<f32> {
    let mut values = Values(Vec::new());
    model.visit(&mut values);
    values.0
}

struct Values(Vec<f32>);

impl ModuleVisitor for Values {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        self.0.extend(param.val().into_data().iter::<f32>());
    }
}

/// Fingerprint of the [`values`] of a model. A file's bytes would not do: they also hold identifiers that are drawn anew
/// for every model.
pub(crate) fn fingerprint(model: &impl Module) -> Fingerprint {
    let bytes: Vec<u8> = values(model)
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect();
    Fingerprint::of_bytes(&bytes)
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
