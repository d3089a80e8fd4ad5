use std::path::PathBuf;

use burn::tensor::Device;
use shared::model::dimensions::Companding;
use tempfile::{TempDir, tempdir};

use super::*;
use crate::teacher::model::TeacherConfig;

const CLASSES: usize = 3;

fn config() -> TeacherConfig {
    TeacherConfig {
        window: 600,
        patch: 1,
        companding: Companding::Linear,
        d_model: 8,
        heads: 2,
        layers: 1,
        feed_forward: 16,
        dropout: 0.0,
        attention_dropout: 0.0,
    }
}

fn teacher(config: &TeacherConfig) -> Teacher {
    Teacher::new(1, config, CLASSES, &Device::default())
}

/// Shape and values of tensors by name.
type Tensors = BTreeMap<String, (Vec<usize>, Vec<f32>)>;

/// Checkpoint of [`config`] whose tensors `change` has edited.
fn changed(change: impl Fn(&mut Tensors)) -> (TempDir, PathBuf) {
    let folder = tempdir().unwrap();
    let path = folder.path().join("teacher.safetensors");
    save(&path, &teacher(&config()), &[]).unwrap();
    let mut tensors = read(&path)
        .unwrap()
        .into_iter()
        .map(|(name, entry)| (name, (entry.shape, entry.values.try_to_vec().unwrap())))
        .collect();
    change(&mut tensors);
    let bytes: BTreeMap<_, Vec<u8>> = tensors
        .iter()
        .map(|(name, (_, values))| (name, values.iter().flat_map(|v| v.to_le_bytes()).collect()))
        .collect();
    let views = tensors.iter().map(|(name, (shape, _))| {
        let view = TensorView::new(Dtype::F32, shape.clone(), &bytes[name]).unwrap();
        (name, view)
    });
    std::fs::write(&path, safetensors::serialize(views, None).unwrap()).unwrap();
    (folder, path)
}

fn weights(teacher: &Teacher) -> BTreeMap<String, Vec<f32>> {
    let named = own_tensors(teacher).into_iter().map(|tensor| {
        let name = tensor.name.clone();
        let data = bridge::into_data(tensor).unwrap();
        (name, data.try_to_vec().unwrap())
    });
    named.collect()
}

#[test]
fn saved_weights_are_loaded() {
    let device = Device::default();
    for patch in [1, 20] {
        let config = TeacherConfig { patch, ..config() };
        let folder = tempdir().unwrap();
        let path = folder.path().join("teacher.safetensors");
        let [one, other] = [1, 2].map(|seed| Teacher::new(seed, &config, CLASSES, &device));
        assert_ne!(weights(&one), weights(&other));
        save(&path, &one, &[]).unwrap();
        let loaded = load(&path, other).unwrap();
        assert_eq!(weights(&loaded), weights(&one));
    }
}

/// Asserts what is said of a changed checkpoint that is loaded into a teacher of so many classes.
#[track_caller]
fn refused(words: &str, classes: usize, change: impl Fn(&mut Tensors)) {
    let (_folder, path) = changed(change);
    let teacher = Teacher::new(1, &config(), classes, &Device::default());
    let error = load(&path, teacher).unwrap_err().to_string();
    assert!(error.contains(words), "{words}: {error}");
}

#[test]
fn a_checkpoint_of_another_model_is_refused_with_what_differs() {
    let bias = "transformer_encoder.layers.0.self_attn.in_proj_bias";
    let words = format!("these tensors are missing: action_embedding.weight, {bias};");
    refused(&words, CLASSES, |tensors| {
        tensors.remove("action_embedding.weight");
        tensors.remove(bias);
    });
    let words = "does not have these tensors: final_norm.bias;";
    refused(words, CLASSES, |tensors| {
        let more = tensors["emg_in_layer_norm.bias"].clone();
        tensors.insert("final_norm.bias".into(), more);
    });
    let words = "action_embedding.weight has shape [4, 8], expected [7, 8]";
    refused(words, 6, |_| {});
    let linear = "transformer_encoder.layers.0.linear1.weight";
    refused(&format!("{linear} has shape"), CLASSES, |tensors| {
        tensors.get_mut(linear).unwrap().0.reverse();
    });
    refused("differ, expected one encoding", CLASSES, |tensors| {
        tensors.get_mut(POSITION_AGAIN).unwrap().1[0] += 1.0;
    });
}

#[test]
fn files_of_other_kinds_are_refused() {
    let folder = tempdir().unwrap();
    for name in ["teacher.pth", "teacher.pt", "teacher.safetensors"] {
        let path = folder.path().join(name);
        std::fs::write(&path, b"not a checkpoint").unwrap();
        let why = load(&path, teacher(&config())).unwrap_err().why;
        assert!(matches!(why, Fault::Unreadable(_)), "{name}: {why}");
    }
    let other = folder.path().join("teacher.bpk");
    let why = load(&other, teacher(&config())).unwrap_err().why;
    assert!(matches!(why, Fault::Format), "{why}");
}

#[test]
fn the_same_teacher_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let teacher = teacher(&config());
    let seen = ["a/1".to_owned(), "b/2".to_owned()];
    let written = |name: &str| {
        let path = folder.path().join(name);
        save(&path, &teacher, &seen).unwrap();
        assert_eq!(subjects_seen(&path).unwrap().unwrap(), seen);
        std::fs::read(path).unwrap()
    };
    let first = written("first.safetensors");
    // The order of a map's keys is random each time.
    for _ in 0..8 {
        assert!(written("again.safetensors") == first);
    }
}
