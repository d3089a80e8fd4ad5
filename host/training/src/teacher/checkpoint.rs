//! Checkpoints of the reference implementation: the `.pth` that its trainer writes, or safetensors
//! with the same tensors under the same names.
//!
//! Names and shapes differ from this crate's teacher where the reference uses another kind of layer (a convolution of width
//! 1 for a linear map) or keeps axes of length 1; the order of the values is the same. A checkpoint holds only weights: the
//! number of heads, the companding and the dropout are those of the teacher that it is loaded into.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use burn::store::{
    BurnToPyTorchAdapter, ModuleSnapshot as _, ModuleStore, PyTorchToBurnAdapter, PytorchStore,
    SafetensorsStore, bridge, burn_pack,
};
use burn::tensor::{DType, TensorData};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};

use super::model::Teacher;
use execution::bounded_read;
use execution::run_folder::{RunError, write_whole};

mod error;

pub use error::{CheckpointError, Fault};

/// Names under which the reference saves the positional encoding that EMG and intents share.
const POSITION: &str = "emg_positional_encoding";
const POSITION_AGAIN: &str = "action_positional_encoding";

/// Shape and values of a tensor in a file.
struct Entry {
    shape: Vec<usize>,
    values: TensorData,
}

/// Adds the file to a fault.
fn at<T>(path: &Path, result: Result<T, Fault>) -> Result<T, CheckpointError> {
    result.map_err(|why| CheckpointError {
        path: path.to_owned(),
        why,
    })
}

/// Reads the weights of a checkpoint (`.pth`, `.pt` or `.safetensors`) into a teacher of the same dimensions.
pub fn load(path: &Path, teacher: Teacher) -> Result<Teacher, CheckpointError> {
    at(path, read(path).and_then(|file| filled(teacher, file)))
}

/// Fills a teacher with the tensors of a file.
fn filled(mut teacher: Teacher, mut file: BTreeMap<String, Entry>) -> Result<Teacher, Fault> {
    remove_second_position(&mut file)?;
    let (mut tensors, mut missing) = (Vec::new(), Vec::new());
    for own in own_tensors(&teacher) {
        let (name, shape) = reference_entry(&own.name, &own.shape);
        let Some(found) = file.remove(&name) else {
            missing.push(name);
            continue;
        };
        if found.shape != shape {
            return Err(Fault::Shape {
                name,
                expected: shape,
                found: found.shape,
            });
        }
        let (bytes, _, dtype) = found.values.into_parts();
        tensors.push(burn_pack::Tensor::new(
            own.name, dtype, own.shape, None, bytes,
        ));
    }
    if !missing.is_empty() {
        return Err(Fault::Missing(missing));
    }
    if !file.is_empty() {
        return Err(Fault::Unknown(file.into_keys().collect()));
    }

    let result = teacher.apply(tensors, None, Some(Box::new(PyTorchToBurnAdapter)), false);
    if result.errors.is_empty() && result.missing.is_empty() && result.unused.is_empty() {
        Ok(teacher)
    } else {
        Err(Fault::unreadable(result))
    }
}

/// Metadata key of a safetensors file under which [`save`] keeps the people whom the teacher has seen, as JSON.
const SUBJECTS_SEEN: &str = "myointent.subjects_seen";

/// Reads the people whom the teacher of a checkpoint was trained on or validated with, as `data-set/subject`; none if the
/// file does not say so, like those of the reference.
pub(crate) fn subjects_seen(path: &Path) -> Result<Option<Vec<String>>, CheckpointError> {
    if path
        .extension()
        .is_none_or(|extension| extension != "safetensors")
    {
        return Ok(None);
    }
    at(path, seen_in(path))
}

fn seen_in(path: &Path) -> Result<Option<Vec<String>>, Fault> {
    let bytes = bounded_read::read(path, bounded_read::CHECKPOINT).map_err(Fault::unreadable)?;
    let (_, metadata) = SafeTensors::read_metadata(&bytes).map_err(Fault::unreadable)?;
    metadata
        .metadata()
        .as_ref()
        .and_then(|entries| entries.get(SUBJECTS_SEEN))
        .map(|json| serde_json::from_str(json).map_err(Fault::unreadable))
        .transpose()
}

/// Writes a teacher's weights as safetensors, under the reference's names and in its shapes, and the people whom it has
/// seen.
pub fn save(
    path: &Path,
    teacher: &Teacher,
    subjects_seen: &[String],
) -> Result<(), CheckpointError> {
    let written = encoded(teacher, subjects_seen).and_then(|bytes| {
        write_whole(path, &bytes).map_err(|error| match error {
            RunError::Io { source, .. } => Fault::unwritable(source),
            other => Fault::unwritable(other),
        })
    });
    at(path, written)
}

/// Bytes of a teacher's safetensors file.
fn encoded(teacher: &Teacher, subjects_seen: &[String]) -> Result<Vec<u8>, Fault> {
    let mut entries = BTreeMap::new();
    for own in own_tensors(teacher) {
        let (name, shape) = reference_entry(&own.name, &own.shape);
        let data = bridge::into_data(own).map_err(Fault::unwritable)?;
        let (bytes, _, _) = data.convert_dtype(DType::F32).into_parts();
        entries.insert(name, (shape, bytes));
    }
    if let Some(position) = entries.get(POSITION).cloned() {
        entries.insert(POSITION_AGAIN.to_owned(), position);
    }
    let views = entries
        .iter()
        .map(|(name, (shape, bytes))| {
            TensorView::new(Dtype::F32, shape.clone(), bytes).map(|view| (name, view))
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(Fault::unwritable)?;
    // Readers of Hugging Face expect the name of the framework that wrote the tensors.
    let seen = serde_json::to_string(subjects_seen).map_err(Fault::unwritable)?;
    let metadata = HashMap::from([
        ("format".to_owned(), "pt".to_owned()),
        (SUBJECTS_SEEN.to_owned(), seen),
    ]);
    let bytes = safetensors::serialize(views, Some(metadata)).map_err(Fault::unwritable)?;
    with_sorted_header(&bytes).ok_or_else(|| Fault::unwritable("the header is no JSON object"))
}

/// Sorts the header keys of a safetensors file: the library writes the metadata in any order, and the same teacher must
/// give the same bytes.
fn with_sorted_header(file: &[u8]) -> Option<Vec<u8>> {
    let (length, rest) = file.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (header, tensors) = rest.split_at_checked(length)?;
    let entries: BTreeMap<String, BTreeMap<String, serde_json::Value>> =
        serde_json::from_slice(header).ok()?;
    let mut header = serde_json::to_vec(&entries).ok()?;
    // The format pads with spaces, so that tensors begin at a multiple of eight.
    header.resize(header.len().next_multiple_of(8), b' ');
    Some([&(header.len() as u64).to_le_bytes(), &header[..], tensors].concat())
}

/// Collects a teacher's tensors as PyTorch lays them out, under this crate's names.
fn own_tensors(teacher: &Teacher) -> Vec<burn_pack::Tensor> {
    teacher.collect(None, Some(Box::new(BurnToPyTorchAdapter)), false)
}

/// Name and shape in the reference of one of this crate's tensors.
fn reference_entry(own: &str, shape: &[usize]) -> (String, Vec<usize>) {
    match (own, shape) {
        ("emg_embedding.weight", &[to, from]) => (own.to_owned(), vec![to, from, 1]),
        ("emg_head.weight", &[to, from]) => {
            ("emg_output_projection.weight".to_owned(), vec![to, from, 1])
        }
        ("emg_mask", &[d]) => ("linear_projection_learnable_mask".to_owned(), vec![1, d, 1]),
        ("emg_modality", &[d]) => (
            "emg_modality_specific_embedding.emg_id_embedding".to_owned(),
            vec![1, 1, d],
        ),
        ("intent_modality", &[d]) => (
            "action_modality_specific_embedding".to_owned(),
            vec![1, 1, d],
        ),
        ("position", &[tokens, d]) => (POSITION.to_owned(), vec![1, tokens, d]),
        ("intent_embedding", _) => ("action_embedding.weight".to_owned(), shape.to_vec()),
        _ => {
            let name = own
                .replace("emg_norm.", "emg_in_layer_norm.")
                .replace("emg_head.", "emg_output_projection.")
                .replace("intent_head.", "action_output_projection.")
                .replace("layers.", "transformer_encoder.layers.")
                .replace(".qkv.", ".self_attn.in_proj_")
                .replace(".out.", ".self_attn.out_proj.");
            (name, shape.to_vec())
        }
    }
}

/// Reads all tensors of a file as f32, by the reference's names.
fn read(path: &Path) -> Result<BTreeMap<String, Entry>, Fault> {
    let tensors = match path.extension().and_then(|extension| extension.to_str()) {
        Some("pth" | "pt") => {
            // LoRA adapters have their own key beside the model's state. They are read too, so that they are refused by
            // name rather than ignored.
            let mut store = PytorchStore::from_file(path)
                .with_top_level_key("model_info")
                .map_indices_contiguous(false);
            let tensors = store.get_all_tensors().map_err(Fault::unreadable)?;
            let strip = |name: &str| {
                name.strip_prefix("model_state_dict.")
                    .unwrap_or(name)
                    .to_owned()
            };
            tensors
                .iter()
                .map(|(name, tensor)| (strip(name), tensor.clone()))
                .collect()
        }
        Some("safetensors") => {
            let mut store = SafetensorsStore::from_file(path);
            store.get_all_tensors().map_err(Fault::unreadable)?.clone()
        }
        _ => return Err(Fault::Format),
    };
    tensors
        .into_iter()
        .map(|(name, tensor): (String, burn_pack::Tensor)| {
            if !tensor.dtype.is_float() {
                let reason = format!("{name} is of type {:?}", tensor.dtype);
                return Err(Fault::Unreadable(reason));
            }
            let shape = tensor.shape.to_vec();
            let values = bridge::into_data(tensor)
                .map_err(|error| Fault::Unreadable(format!("{name}: {error}")))?
                .convert_dtype(DType::F32);
            Ok((name, Entry { shape, values }))
        })
        .collect()
}

/// Removes the positional encoding's second copy, which must be equal to the first.
fn remove_second_position(file: &mut BTreeMap<String, Entry>) -> Result<(), Fault> {
    let again = file.remove(POSITION_AGAIN);
    let again = again.ok_or_else(|| Fault::Missing(vec![POSITION_AGAIN.to_owned()]))?;
    match file.get(POSITION) {
        Some(first) if first.values != again.values => Err(Fault::Positions),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
