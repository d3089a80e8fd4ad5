use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use burn::module::Module as _;
use burn::nn::{Initializer, Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData};

use super::*;
use crate::optimization::learner::WeightedMetric;
use crate::optimization::read_back;
use execution::run_folder::kill;
use presets::training::LrSchedule;

/// Learns `y = 2 x`. Its validation loss is lowest at `y = x`, so the best epoch is in the middle.
struct LineLearner {
    device: Device,
    /// Number of losses computed.
    losses: AtomicUsize,
    /// Interrupt of the user after this many losses.
    stop: Option<(Interrupt, usize)>,
}

impl Learner for LineLearner {
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

    fn shards(&self, item: &f32, rng: &mut ChaCha8Rng) -> Vec<f32> {
        use rand::RngExt as _;
        vec![*item * rng.random_range(0.9..1.1)]
    }

    fn loss(&self, model: &Linear, x: f32) -> (Tensor<1>, Vec<WeightedMetric>) {
        let input = Tensor::<2>::from_data(TensorData::new(vec![x], [1, 1]), &self.device);
        let loss = (model.forward(input.clone()) - input * 2.0)
            .powi_scalar(2)
            .mean();
        let losses = self.losses.fetch_add(1, Ordering::SeqCst) + 1;
        if let Some((interrupt, _)) = self.stop.as_ref().filter(|(_, after)| losses == *after) {
            interrupt.request();
        }
        let metric = WeightedMetric {
            name: "loss",
            mean: f64::from(x),
            weight: 1.0,
        };
        (loss, vec![metric])
    }

    fn validate(&self, model: &Linear) -> (f64, Vec<(&'static str, f64)>) {
        let weight = f64::from(read_back(model.weight.val())[0]);
        let loss = (weight - 1.0).powi(2);
        (loss, vec![("loss", loss)])
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

/// Trains to the end. Returns the final model's weight and the lines of metrics.
fn trained(folder: &Path, resume: bool, checkpoint_every: Duration) -> (Vec<f32>, String) {
    let weight = run(folder, resume, checkpoint_every, None).unwrap();
    let metrics = std::fs::read_to_string(folder.join("line.jsonl")).unwrap();
    (weight, metrics)
}

/// Trains until `stop` interrupts. Returns the final model's weight.
fn run(
    folder: &Path,
    resume: bool,
    checkpoint_every: Duration,
    stop: Option<usize>,
) -> Result<Vec<f32>, RunError> {
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
        checkpoint_every,
        interrupt: &interrupt,
    };
    let line = LineLearner {
        device,
        losses: AtomicUsize::new(0),
        stop: stop.map(|after| (interrupt.clone(), after)),
    };
    let model = fit(&line, model, CONFIG, &training)?;
    Ok(read_back(model.valid().weight.val()))
}

#[test]
fn a_training_killed_at_any_write_resumes_to_the_same_model() {
    let folder = tempfile::tempdir().unwrap();
    let whole = trained(&folder.path().join("whole"), false, CHECKPOINT_EVERY);
    assert_eq!(whole.1.lines().count(), CONFIG.epochs);
    // With a checkpoint after every epoch, and after every step.
    for every in [CHECKPOINT_EVERY, Duration::ZERO] {
        let mut kills = 0;
        loop {
            let path = folder.path().join(format!("{every:?}-{kills}"));
            let killed = kill::after(kills, || trained(&path, false, every)).is_none();
            if !killed {
                break;
            }
            let resumed = trained(&path, true, every);
            assert_eq!(resumed, whole, "killed at point {kills}, {every:?}");
            kills += 1;
        }
        let checkpoints = if every.is_zero() { 4 } else { 1 } * CONFIG.epochs;
        assert!(kills > 3 * checkpoints, "{kills} kills");
    }
}

#[test]
fn a_stop_loses_no_step() {
    let folder = tempfile::tempdir().unwrap();
    let whole = trained(&folder.path().join("whole"), false, CHECKPOINT_EVERY);
    let steps = 3 * CONFIG.epochs;
    for after in 1..steps {
        let path = folder.path().join(after.to_string());
        let stopped = run(&path, false, CHECKPOINT_EVERY, Some(after));
        assert!(matches!(stopped, Err(RunError::Interrupted { .. })));
        // Only the remaining steps are computed: one more loss would interrupt.
        let left = run(&path, true, CHECKPOINT_EVERY, Some(steps - after + 1));
        assert_eq!(left.unwrap(), whole.0, "stopped after {after} steps");
        let metrics = std::fs::read_to_string(path.join("line.jsonl")).unwrap();
        assert_eq!(metrics, whole.1, "stopped after {after} steps");
    }
}
