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
    Teacher::new(config, CLASSES, &Device::default())
}

/// Checkpoint of [`config`] whose tensors `change` has edited.
fn changed(change: impl Fn(&mut BTreeMap<String, (Vec<usize>, Vec<f32>)>)) -> (TempDir, PathBuf) {
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
    own_tensors(teacher)
        .into_iter()
        .map(|tensor| {
            let name = tensor.name.clone();
            (
                name,
                bridge::into_data(tensor).unwrap().try_to_vec().unwrap(),
            )
        })
        .collect()
}

#[test]
fn saved_weights_are_loaded() {
    for patch in [1, 20] {
        let config = TeacherConfig { patch, ..config() };
        let folder = tempdir().unwrap();
        let path = folder.path().join("teacher.safetensors");
        let (one, other) = (teacher(&config), teacher(&config));
        assert_ne!(weights(&one), weights(&other));
        save(&path, &one, &[]).unwrap();
        let loaded = load(&path, other).unwrap();
        assert_eq!(weights(&loaded), weights(&one));
    }
}

#[test]
fn missing_tensors_are_named() {
    let (_folder, path) = changed(|tensors| {
        tensors.remove("action_embedding.weight");
        tensors.remove("transformer_encoder.layers.0.self_attn.in_proj_bias");
    });
    let Err(CheckpointError::Missing { mut names, .. }) = load(&path, teacher(&config())) else {
        panic!("loaded");
    };
    names.sort();
    assert_eq!(
        names,
        [
            "action_embedding.weight",
            "transformer_encoder.layers.0.self_attn.in_proj_bias"
        ]
    );
}

#[test]
fn unknown_tensors_are_named() {
    let (_folder, path) = changed(|tensors| {
        let more = tensors["emg_in_layer_norm.bias"].clone();
        tensors.insert("final_norm.bias".into(), more);
    });
    let Err(CheckpointError::Unknown { names, .. }) = load(&path, teacher(&config())) else {
        panic!("loaded");
    };
    assert_eq!(names, ["final_norm.bias"]);
}

#[test]
fn another_number_of_classes_is_reported_with_both_shapes() {
    let (_folder, path) = changed(|_| {});
    let six = Teacher::new(&config(), 6, &Device::default());
    let Err(CheckpointError::Shape {
        name,
        expected,
        found,
        ..
    }) = load(&path, six)
    else {
        panic!("loaded");
    };
    assert_eq!(name, "action_embedding.weight");
    assert_eq!((expected, found), (vec![7, 8], vec![4, 8]));
}

#[test]
fn transposed_weights_are_refused() {
    let (_folder, path) = changed(|tensors| {
        let name = "transformer_encoder.layers.0.linear1.weight";
        tensors.get_mut(name).unwrap().0.reverse();
    });
    assert!(matches!(
        load(&path, teacher(&config())),
        Err(CheckpointError::Shape { .. })
    ));
}

#[test]
fn positions_that_are_not_shared_are_refused() {
    let (_folder, path) = changed(|tensors| tensors.get_mut(POSITION_AGAIN).unwrap().1[0] += 1.0);
    assert!(matches!(
        load(&path, teacher(&config())),
        Err(CheckpointError::Positions { .. })
    ));
}

#[test]
fn files_of_other_kinds_are_refused() {
    let folder = tempdir().unwrap();
    for name in ["teacher.pth", "teacher.pt", "teacher.safetensors"] {
        let path = folder.path().join(name);
        std::fs::write(&path, b"not a checkpoint").unwrap();
        assert!(
            matches!(
                load(&path, teacher(&config())),
                Err(CheckpointError::Unreadable { .. })
            ),
            "{name}"
        );
    }
    assert!(matches!(
        load(&folder.path().join("teacher.bpk"), teacher(&config())),
        Err(CheckpointError::Format { .. })
    ));
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
