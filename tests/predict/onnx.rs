//! The float student as an ONNX file, in ONNX Runtime: its logits beside those of our own float student and of the integers.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use burn::tensor::{Device, Tensor};
use evaluation::inference::{input, outputs};
use evaluation::smooth;
use myointent_tests::{data, skip};
use recordings::npy::{self, Values};
use recordings::{LoadOptions, Recording, load};
use shared::model::LookBackLogits;
use shared::model::file::Model;
use shared::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH};
use training::run::context::{RunContext, load_student};
use training::student::dequantization::dequantize;
use training::student::model::Student;

use crate::small::{folder, in_folder, myointent, recordings as synthetic, small_preset};

/// Half a minute.
const PATCHES: usize = 600;

/// Python of the environment of `host/python/test`; without ONNX Runtime in it, books the test as skipped.
fn python() -> Option<PathBuf> {
    let python = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../python/bin/python");
    let found = Command::new(&python)
        .args(["-c", "import onnxruntime"])
        .output()
        .is_ok_and(|found| found.status.success());
    if !found {
        skip("no onnxruntime: `host/python/test --install` installs it");
    }
    found.then_some(python)
}

/// Logits of each patch in ONNX Runtime, from the beginning of the stream, and the file's properties.
fn in_the_runtime(
    python: &Path,
    file: &Path,
    emg: &[CleanSample],
) -> (Vec<f32>, serde_json::Value) {
    let [patches, logits] = ["patches.npy", "logits.npy"].map(|name| file.with_file_name(name));
    let values = over_128(emg);
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let shape = [emg.len() / PATCH, PATCH, CHANNELS];
    fs::write(&patches, npy::encode("<f4", &shape, &bytes)).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("predict/stream.py");
    let streamed = Command::new(python)
        .args([&script, file, &patches, &logits])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&streamed.stderr);
    assert!(streamed.status.success(), "{said}");
    let Values::Numbers(values) = npy::read(&logits).unwrap().values else {
        panic!("expected numbers");
    };
    let properties = serde_json::from_slice(&streamed.stdout).unwrap();
    (
        values.iter().map(|&value| value as f32).collect(),
        properties,
    )
}

fn over_128(emg: &[CleanSample]) -> Vec<f32> {
    let values = emg.as_flattened().iter();
    values.map(|&value| f32::from(value) / 128.0).collect()
}

/// Logits of each patch of our own float student, from the beginning of the stream.
fn by_the_student(student: &Student, emg: &[CleanSample], device: &Device) -> Vec<f32> {
    let shape = [1, emg.len() / PATCH, PATCH * CHANNELS];
    let emg = Tensor::<1>::from_floats(over_128(emg).as_slice(), device).reshape(shape);
    student.forward(emg).try_into_vec_as::<f32>().unwrap()
}

fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f32::max)
}

/// Rows of logits, as a smoother takes them.
fn rows(logits: &[f32], patches: usize) -> Vec<LookBackLogits> {
    let columns = logits.len() / patches / LOOK_BACK;
    let mut all = vec![LookBackLogits::default(); patches];
    for (row, logits) in all
        .as_flattened_mut()
        .iter_mut()
        .zip(logits.chunks(columns))
    {
        row[..columns].copy_from_slice(logits);
    }
    all
}

/// A recording of each of some sets.
fn published(data: &Path) -> Vec<Recording> {
    let sets = ["ss-stm", "roshambo", "myoup", "epn"];
    let of_set = |set: &str| load(&data.join(set), &LoadOptions::default()).unwrap_or_default();
    let long = |own: &Recording| own.samples.len() >= PATCHES * PATCH;
    let one = |set| of_set(set).recordings.into_iter().find(long);
    sets.into_iter().filter_map(one).collect()
}

#[test]
fn the_runtime_gives_the_logits_of_the_float_student_and_the_integers_nearly_its_labels() {
    let (Some(data), Some(python)) = (data(), python()) else {
        return;
    };
    let (folder, device) = (folder("onnx"), Device::default());
    for name in ["three-class", "six-class"] {
        let shipped = myointent_tests::shipped(name);
        let file = folder.join(format!("{name}.onnx"));
        let out = file.display();
        let export = format!("export --onnx --model {} --out {out}", shipped.display());
        assert!(myointent(&export));
        assert!(!myointent(&export), "the file is there already");
        let bytes = fs::read(&shipped).unwrap();
        let model = Model::parse(&bytes).unwrap();
        let (student, _) = dequantize(&model.to_parts(), &device);
        let intents = model.header.dimensions.vocabulary.intents();
        let recordings = published(&data);
        assert!(!recordings.is_empty());
        for own in recordings {
            let emg = input(&own.samples[..PATCHES * PATCH], model.header.preprocessing);
            let (found, properties) = in_the_runtime(&python, &file, &emg);
            let other = model.header.dimensions.other.then_some("other");
            let names = intents.iter().map(|intent| intent.name());
            let names: Vec<&str> = names.chain(other).collect();
            assert_eq!(properties["columns"], names.join(","));
            assert_eq!(properties["normalized"], "true");

            let float = by_the_student(&student, &emg, &device);
            let difference = largest_difference(&found, &float);
            assert!(difference <= 1e-4, "{}: {difference}", own.full_name());

            let integers = outputs(&model, emg.as_chunks().0).unwrap();
            let float = rows(&found, PATCHES);
            let [a, b] = [&float, &integers].map(|rows| rows.as_flattened().as_flattened());
            let difference = largest_difference(a, b);
            let settings = model.header.smoother.in_patches();
            let [a, b] = [&float, &integers].map(|rows| {
                smooth(rows, emg.len(), intents.len(), settings)
                    .unwrap()
                    .emitted
            });
            let equal = a.iter().zip(&b).filter(|(a, b)| a == b).count();
            let equal = equal as f64 / emg.len() as f64;
            println!("{name}, {}: {difference:.3}, {equal:.4}", own.full_name());
            assert!(difference < 0.1, "{}: {difference}", own.full_name());
            assert!(equal > 0.99, "{}: {equal}", own.full_name());
        }
    }
}

#[test]
fn the_student_of_a_run_is_written_as_it_was_trained() {
    let Some(python) = python() else { return };
    let folder = folder("onnx-of-a-run");
    small_preset(&folder);
    let data = synthetic(&folder);
    let train = "train --preset @small.toml --data @data --run @run";
    assert!(in_folder(&folder, train));
    assert!(in_folder(&folder, "export --onnx --run @run"));
    let run = folder.join("run");

    let (run_folder, config) = RunContext::find(&run).unwrap();
    let device = Device::default();
    let name = presets::distillation::NAME;
    let student = load_student(&run_folder, &config, name, &device).unwrap();
    let own = load(&data, &LoadOptions::default()).unwrap();
    let samples = &own.recordings[0].samples[..1000];
    let emg = input(samples, config.preset.preprocessing());
    let (found, _) = in_the_runtime(&python, &run.join("student.onnx"), &emg);
    let difference = largest_difference(&found, &by_the_student(&student, &emg, &device));
    assert!(difference <= 1e-4, "{difference}");
}
