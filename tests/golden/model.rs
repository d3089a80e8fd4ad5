//! Teacher with the reference's weights: golden/model.

use std::collections::BTreeMap;
use std::path::Path;

use burn::module::Module as _;
use burn::tensor::{Device, Tensor, TensorData};
use myointent_tests::golden;
use presets::Preset;
use safetensors::SafeTensors;
use shared::units::{CHANNELS, WINDOW};
use training::optimization::read_back;
use training::teacher::checkpoint::{load, save};
use training::teacher::model::{Teacher, TeacherConfig, TeacherInput, TeacherOutput};

use crate::files::json;

/// Number of intents; MASK is the class after them.
const CLASSES: usize = 3;
/// Tolerance for f32 sums in another order: the reference's own two precisions are 1.5e-6 apart.
const TOLERANCE: f32 = 1e-5;

/// Values by name, with their shapes.
pub type Tensors = BTreeMap<String, (Vec<usize>, Vec<f32>)>;

/// Reads all tensors of a file; whole numbers and flags are exact as f32.
pub fn tensors(path: &Path) -> Tensors {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let file = SafeTensors::deserialize(&bytes).unwrap();
    let tensors = file.iter().map(|(name, view)| {
        let data = view.data();
        let values = match view.dtype() {
            safetensors::Dtype::F32 => {
                let (values, _) = data.as_chunks();
                values.iter().map(|&v| f32::from_le_bytes(v)).collect()
            }
            safetensors::Dtype::F64 => {
                let (values, _) = data.as_chunks();
                values
                    .iter()
                    .map(|&v| f64::from_le_bytes(v) as f32)
                    .collect()
            }
            safetensors::Dtype::I64 => {
                let (values, _) = data.as_chunks();
                values
                    .iter()
                    .map(|&v| i64::from_le_bytes(v) as f32)
                    .collect()
            }
            safetensors::Dtype::U8 => data.iter().map(|&v| f32::from(v)).collect(),
            other => panic!("{}: {name} is {other:?}", path.display()),
        };
        (name.to_owned(), (view.shape().to_vec(), values))
    });
    tensors.collect()
}

/// Returns the dimensions that the paper trains with.
fn paper() -> TeacherConfig {
    Preset::find("paper").unwrap().teacher
}

pub fn reference(golden: &Path, file: &str, device: &Device) -> Teacher {
    load(
        &golden.join("model").join(file),
        Teacher::new(1, &paper(), CLASSES, device),
    )
    .unwrap()
}

/// Builds the reference's input, of all windows.
pub fn input(
    emg: &[f32],
    emg_mask: &[f32],
    intent: &[f32],
    blocked: bool,
    device: &Device,
) -> TeacherInput {
    let windows = intent.len() / WINDOW;
    let mut shares = vec![0.0_f32; intent.len() * (CLASSES + 1)];
    for (token, &class) in shares.chunks_exact_mut(CLASSES + 1).zip(intent) {
        token[class as usize] = 1.0;
    }
    let tensor = |values: &[f32], width| {
        Tensor::from_data(
            TensorData::new(values.to_vec(), [windows, WINDOW, width]),
            device,
        )
    };
    TeacherInput {
        emg: tensor(emg, CHANNELS),
        emg_mask: tensor(emg_mask, 1),
        intent: tensor(&shares, CLASSES + 1),
        blocked: blocked.then(|| Tensor::ones([windows], device)),
    }
}

/// Returns the largest difference of two lists of equal length.
fn distance(found: &[f32], expected: &[f32]) -> f32 {
    assert_eq!(found.len(), expected.len());
    let differences = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
    // A maximum of f32 ignores NaN.
    differences.fold(
        0.0,
        |most, d| if d.is_nan() { f32::NAN } else { most.max(d) },
    )
}

#[test]
fn outputs_are_the_references_in_every_case() {
    let golden = golden();
    let device = Device::default();
    let teacher = reference(&golden, "checkpoint.pth", &device);
    let cases = tensors(&golden.join("model/cases.safetensors"));
    let index = json(&golden.join("model/index.json"));
    let named = index["cases"].as_object().unwrap();
    for (name, case) in named {
        let values = |part: &str| &cases[&format!("{name}.{part}")].1[..];
        let blocked = case["task"] == 3;
        let TeacherOutput { emg, intent } = teacher.forward(input(
            values("emg"),
            values("emg_mask"),
            values("intent"),
            blocked,
            &device,
        ));
        let emg = distance(&read_back(emg), values("emg_out"));
        let intent = distance(&read_back(intent), values("intent_logits"));
        println!("{name}: EMG off by {emg:.1e}, logits by {intent:.1e}");
        assert!(emg <= TOLERANCE, "{name}: EMG off by {emg}");
        assert!(intent <= TOLERANCE, "{name}: logits off by {intent}");
    }
    assert_eq!(named.len(), 5);
}

#[test]
fn windows_of_different_tasks_share_a_batch() {
    let golden = golden();
    let device = Device::default();
    let teacher = reference(&golden, "model.safetensors", &device);
    let cases = tensors(&golden.join("model/cases.safetensors"));
    let names = ["unlabeled", "partly_masked"];
    let both = |part: &str| -> Vec<f32> {
        let of = |name: &&str| cases[&format!("{name}.{part}")].1.clone();
        names.iter().flat_map(of).collect()
    };
    let mut shown = input(
        &both("emg"),
        &both("emg_mask"),
        &both("intent"),
        false,
        &device,
    );
    shown.blocked = Some(Tensor::from_floats([1.0, 0.0], &device));
    let output = teacher.forward(shown);
    let emg = distance(&read_back(output.emg), &both("emg_out"));
    let intent = distance(&read_back(output.intent), &both("intent_logits"));
    assert!(emg <= TOLERANCE, "EMG off by {emg}");
    assert!(intent <= TOLERANCE, "logits off by {intent}");
}

#[test]
fn use_shows_the_teacher_what_the_reference_is_shown() {
    let golden = golden();
    let device = Device::default();
    let teacher = reference(&golden, "model.safetensors", &device);
    let cases = tensors(&golden.join("model/cases.safetensors"));
    let emg = cases["inference.emg"].1.clone();
    let output = teacher.forward(TeacherInput::for_inference(
        emg,
        paper().window_shape(),
        CLASSES,
        &device,
    ));
    let off = distance(
        &read_back(output.intent),
        &cases["inference.intent_logits"].1,
    );
    assert!(off <= TOLERANCE, "logits off by {off}");
}

#[test]
fn both_formats_are_read_and_written_back_bit_for_bit() {
    let golden = golden();
    let expected = tensors(&golden.join("model/model.safetensors"));
    assert_eq!(expected.len(), 38);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("teacher.safetensors");
    for file in ["checkpoint.pth", "model.safetensors"] {
        save(&path, &reference(&golden, file, &Device::default()), &[]).unwrap();
        assert_eq!(tensors(&path), expected, "{file}");
    }
}

#[test]
fn the_preset_paper_has_the_references_parameters() {
    let golden = golden();
    let index = json(&golden.join("model/index.json"));
    let teacher = Teacher::new(1, &paper(), CLASSES, &Device::default());
    assert_eq!(
        teacher.num_params() as u64,
        index["trainable_parameters"].as_u64().unwrap()
    );
}
