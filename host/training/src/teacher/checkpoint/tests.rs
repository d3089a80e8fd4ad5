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

/// Change of a checkpoint's tensors, classes of the teacher that it is loaded into, and what the error says.
type Case = (fn(&mut Tensors), usize, &'static [&'static str]);

#[test]
fn a_checkpoint_of_another_model_is_refused_with_what_differs() {
    let cases: [Case; 5] = [
        (
            |tensors| {
                tensors.remove("action_embedding.weight");
                tensors.remove("transformer_encoder.layers.0.self_attn.in_proj_bias");
            },
            CLASSES,
            &[
                "these tensors are missing: action_embedding.weight, transformer_encoder.layers.0.self_attn.in_proj_bias;",
            ],
        ),
        (
            |tensors| {
                let more = tensors["emg_in_layer_norm.bias"].clone();
                tensors.insert("final_norm.bias".into(), more);
            },
            CLASSES,
            &["does not have these tensors: final_norm.bias;"],
        ),
        (
            |_| {},
            6,
            &["action_embedding.weight has shape [4, 8], expected [7, 8]"],
        ),
        (
            |tensors| {
                let name = "transformer_encoder.layers.0.linear1.weight";
                tensors.get_mut(name).unwrap().0.reverse();
            },
            CLASSES,
            &["transformer_encoder.layers.0.linear1.weight has shape"],
        ),
        (
            |tensors| tensors.get_mut(POSITION_AGAIN).unwrap().1[0] += 1.0,
            CLASSES,
            &["differ, expected one encoding"],
        ),
    ];
    for (change, classes, expected) in cases {
        let (_folder, path) = changed(change);
        let teacher = Teacher::new(&config(), classes, &Device::default());
        let error = load(&path, teacher).unwrap_err().to_string();
        for part in expected {
            assert!(error.contains(part), "{part}: {error}");
        }
    }
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
    let why = load(&folder.path().join("teacher.bpk"), teacher(&config()))
        .unwrap_err()
        .why;
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
