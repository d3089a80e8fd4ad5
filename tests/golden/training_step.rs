//! One optimizer step from the reference's weights: golden/model/train_step.json.

use std::path::Path;

use burn::module::{Module as _, ModuleMapper, Param};
use burn::optim::GradientsParams;
use burn::tensor::{Device, Tensor, TensorData};
use myointent_tests::golden;
use serde_json::Value;
use shared::units::{CHANNELS, WINDOW};
use training::optimization::optimizer::optimizer;
use training::optimization::read_back;
use training::teacher::batch::Batch;
use training::teacher::checkpoint::save;
use training::teacher::learner::losses;
use training::teacher::model::Teacher;

use crate::files::json;
use crate::model::{Tensors, input, reference, tensors};

/// Width of the paper's tokens.
const WIDTH: usize = 128;

/// Puts gradients where the parameters were, so that they can be written under the reference's names.
struct InPlace<'a>(&'a GradientsParams);

impl ModuleMapper for InPlace<'_> {
    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        let gradient = self.0.get::<D>(param.id).expect("a gradient of everything");
        Param::initialized(param.id, gradient)
    }
}

/// Returns a model's values by the reference's names.
fn by_name(teacher: &Teacher) -> Tensors {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("teacher.safetensors");
    save(&path, teacher, &[]).unwrap();
    tensors(&path)
}

fn norm(values: impl Iterator<Item = f32>) -> f64 {
    values.map(|v| f64::from(v).powi(2)).sum::<f64>().sqrt()
}

fn training_batch(golden: &Path, device: &Device) -> Batch {
    let file = tensors(&golden.join("model/train_batch.safetensors"));
    let values = |part: &str| &file[&format!("train.{part}")].1[..];
    let count = |part: &str| values(part).iter().filter(|&&hidden| hidden > 0.0).count();
    let windows = values("intent_target").len() / WINDOW;
    let input = input(
        values("emg"),
        values("emg_mask"),
        values("intent_input"),
        false,
        device,
    );
    let targets: Vec<i32> = values("intent_target").iter().map(|&c| c as i32).collect();
    let weights = values("intent_mask").to_vec();
    Batch {
        emg_target: input.emg.clone(),
        emg_cells: count("emg_mask") * CHANNELS,
        intent_target: Tensor::from_data(TensorData::new(targets, [windows, WINDOW]), device),
        intent_weight: Tensor::from_data(TensorData::new(weights, [windows, WINDOW]), device),
        intent_samples: count("intent_mask"),
        input,
    }
}

#[test]
fn a_training_step_has_the_references_losses_gradients_and_changes() {
    let golden = golden();
    let expected = json(&golden.join("model/train_step.json"));
    let device = Device::default().autodiff();
    let teacher = reference(&golden, "model.safetensors", &device);
    let batch = training_batch(&golden, &device);
    let step = |teacher: &Teacher, losses_of: &Value| {
        let (emg, intent) = losses(&teacher.forward(batch.input.clone()), &batch);
        for (name, found) in [("emg_loss", &emg), ("intent_loss", &intent)] {
            let (found, expected) = (
                f64::from(read_back(found.clone())[0]),
                losses_of[name].as_f64().unwrap(),
            );
            println!("{name}: {found:.7}, the reference's {expected:.7}");
            assert!((found - expected).abs() < 1e-5, "{name}");
        }
        emg + intent
    };

    let loss = step(&teacher, &expected["f64"]);
    let gradients = GradientsParams::from_grads(loss.backward(), &teacher);
    let found = by_name(&teacher.clone().map(&mut InPlace(&gradients)));
    for (name, expected) in expected["gradients_f64"].as_object().unwrap() {
        check_gradient(name, &found[name].1, expected);
    }

    let before = by_name(&teacher);
    let settings = &expected["optimizer"];
    let decay = settings["weight_decay"].as_f64().unwrap() as f32;
    let rate = settings["lr"].as_f64().unwrap();
    let teacher = optimizer(decay).step(rate, teacher, gradients);
    let after = by_name(&teacher);
    for (name, expected) in expected["parameter_delta_l2_f64"].as_object().unwrap() {
        let pairs = before[name].1.iter().zip(&after[name].1);
        // A key's bias adds the same to all scores of a query, so its gradient is 0. AdamW divides the rounding error
        // of f32 in it by its own size: the reference's f64 has less of it.
        let keys = if name.ends_with("in_proj_bias") {
            WIDTH..2 * WIDTH
        } else {
            0..0
        };
        let pairs = pairs
            .enumerate()
            .filter(|(at, _)| !keys.contains(at))
            .map(|(_, pair)| pair);
        let (found, expected) = (norm(pairs.map(|(a, b)| b - a)), expected.as_f64().unwrap());
        println!("{name}: moved by {found:.6e}, the reference by {expected:.6e}");
        assert!((found / expected - 1.0).abs() < 1e-3, "{name}");
    }
    step(&teacher, &expected["f64"]["after_one_step"]);
}

fn check_gradient(name: &str, found: &[f32], expected: &Value) {
    let number = |key: &str| expected[key].as_f64().unwrap();
    let length = norm(found.iter().copied());
    let sum: f64 = found.iter().map(|&g| f64::from(g)).sum();
    println!(
        "{name}: norm off by {:.1e}, sum by {:.1e}",
        length / number("l2") - 1.0,
        sum - number("sum")
    );
    assert!((length / number("l2") - 1.0).abs() < 1e-4, "{name}: norm");
    // The tolerance is that of a sum of n errors, each small beside the gradient's mean magnitude.
    assert!(
        (sum - number("sum")).abs() < 1e-4 * number("l2"),
        "{name}: sum"
    );
    for (found, expected) in found.iter().zip(expected["first8"].as_array().unwrap()) {
        let off = (f64::from(*found) - expected.as_f64().unwrap()).abs();
        assert!(off < 1e-5 * number("l2"), "{name}: first values");
    }
}
