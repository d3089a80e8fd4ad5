use std::path::Path;

use burn::module::Module as _;
use burn::nn::{Initializer, Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData};

use super::*;
use crate::execution::run_folder::kill;
use crate::training::learner::WeightedMetric;
use crate::training::tensor::read_back;

/// Learns `y = 2 x`. Its validation loss is lowest at `y = x`, so the best epoch is in the middle.
struct Line {
    device: Device,
}

impl Learner for Line {
    type Model = Linear;
    type Item = f32;
    type Shard = f32;

    fn name(&self) -> &'static str {
        "line"
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<f32> {
        use rand::RngExt as _;
        (0..3).map(|_| rng.random_range(0.5..1.5)).collect()
    }

    fn steps(&self) -> usize {
        3
    }

    fn shards(&self, item: &f32, _: &mut ChaCha8Rng) -> Vec<f32> {
        vec![*item]
    }

    fn loss(&self, model: &Linear, x: f32) -> (Tensor<1>, Vec<WeightedMetric>) {
        let input = Tensor::<2>::from_data(TensorData::new(vec![x], [1, 1]), &self.device);
        let loss = (model.forward(input.clone()) - input * 2.0)
            .powi_scalar(2)
            .mean();
        (loss, vec![metric(1.0)])
    }

    fn validate(&self, model: &Linear) -> (f64, Vec<WeightedMetric>) {
        let weight = f64::from(read_back(model.weight.val())[0]);
        let loss = (weight - 1.0).powi(2);
        (loss, vec![metric(loss)])
    }
}

fn metric(mean: f64) -> WeightedMetric {
    WeightedMetric {
        name: "loss",
        mean,
        weight: 1.0,
    }
}

const CONFIG: TrainConfig = TrainConfig {
    epochs: 4,
    learning_rate: 0.2,
    lr_schedule: LrSchedule::Constant,
    weight_decay: 0.01,
    ema_decay: 0.5,
    seed: 1,
};

/// The final model's weight and the lines of metrics.
fn trained(folder: &Path, resume: bool) -> (Vec<f32>, String) {
    let device = Device::default().autodiff();
    let model = LinearConfig::new(1, 1)
        .with_bias(false)
        .with_initializer(Initializer::Zeros)
        .init(&device);
    let run = RunFolder::open(folder).unwrap();
    let interrupt = Interrupt::default();
    let training = Training {
        run: &run,
        made_from: Fingerprint::of_bytes(b"recordings"),
        resume,
        interrupt: &interrupt,
    };
    let model = fit(&Line { device }, model, CONFIG, &training).unwrap();
    let metrics = std::fs::read_to_string(folder.join("line.jsonl")).unwrap();
    (read_back(model.valid().weight.val()), metrics)
}

#[test]
fn a_training_killed_at_any_write_resumes_to_the_same_model() {
    let folder = tempfile::tempdir().unwrap();
    let whole = trained(&folder.path().join("whole"), false);
    assert_eq!(whole.1.lines().count(), CONFIG.epochs);
    let mut kills = 0;
    loop {
        let path = folder.path().join(kills.to_string());
        let killed = kill::after(kills, || trained(&path, false)).is_none();
        if !killed {
            break;
        }
        assert_eq!(trained(&path, true), whole, "killed at point {kills}");
        kills += 1;
    }
    assert!(kills > 3 * CONFIG.epochs, "{kills} kills");
}
