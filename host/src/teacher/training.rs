//! Trains a teacher on windows, tasks and masks that are renewed each epoch.

use burn::module::{Lora, Module as _, ParamGroup};
use burn::tensor::{Device, Tensor};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::masking::Task;
use super::model::{Teacher, TeacherOutput};
use super::window::{Batch, Example, Grid, batch, examples, inference_input};
use crate::dataset::corpus::Corpus;
use crate::execution::interrupt::Interrupt;
use crate::execution::run_folder::{RunError, RunFolder};
use crate::training::augmentation::{Augmentation, Variation};
use crate::training::fit::{Learner, SHARDS, TrainConfig, WeightedMetric, fit};
use crate::training::loss::cross_entropy;
use crate::training::schedule::LrSchedule;
use crate::training::tensor::best_class;
use crate::training::tensor::read_back;

/// Name of the run's files: `teacher.bpk` is the checkpoint of the lowest validation loss.
pub const NAME: &str = "teacher";
/// Name of the files of a run with low-rank additions, before they are merged into the teacher.
const ADAPTED: &str = "teacher-lora";

/// How a teacher is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TeacherTraining {
    /// Samples between the starts of two windows.
    pub stride: usize,
    /// Passes over all examples.
    pub epochs: usize,
    /// Examples a step.
    pub batch: usize,
    /// Peak learning rate.
    pub learning_rate: f64,
    /// How the rate changes: a warm-up for a fresh model, a constant rate for fine-tuning in the paper.
    pub lr_schedule: LrSchedule,
    /// Decoupled weight decay, on every parameter.
    pub weight_decay: f32,
    /// Decay of the exponential moving average of the weights that is saved; 0, as in the paper, saves those of the last step.
    #[serde(default)]
    pub ema_decay: f64,
    /// Tasks; every window is presented once as each.
    pub tasks: Vec<Task>,
    /// Variations of the training windows; none in the paper.
    pub augmentation: Option<Augmentation>,
    /// Trains low-rank additions and leaves the weights that training starts from as they are.
    pub lora: Option<LoraConfig>,
}

/// Low-rank adaptation of the feed-forward blocks and of the intent head, the layers that the
/// reference's option reaches (its defaults: rank 16, alpha 8, and a dropout of 0.05 on the
/// additions, which is left out here).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoraConfig {
    /// Rank of an addition.
    pub rank: usize,
    /// Additions are scaled by `alpha / rank`.
    pub alpha: f64,
}

impl LoraConfig {
    /// The model with additions, which are all that is trained; at first they change nothing.
    #[must_use]
    pub fn adapt(self, model: Teacher) -> Teacher {
        let mut paths = vec!["intent_head.weight".to_owned()];
        for layer in 0..model.depth() {
            paths
                .extend(["linear1", "linear2"].map(|name| format!("layers.{layer}.{name}.weight")));
        }
        let lora = Lora::new(self.rank, self.alpha).set_param_group(ParamGroup::from_paths(paths));
        model.apply_lora(lora)
    }
}

/// A teacher's training, batch by batch.
pub struct TeacherLearner<'a> {
    grid: Grid,
    corpus: &'a Corpus,
    validation: &'a Corpus,
    config: &'a TeacherTraining,
    examples: Vec<Example>,
    checks: Vec<Example>,
    seed: u64,
    device: &'a Device,
}

/// Trains a model whose windows lie on `grid`.
///
/// # Errors
/// When the folder cannot be written or the user interrupts.
#[expect(clippy::too_many_arguments, reason = "a run is what these say")]
pub fn train(
    model: Teacher,
    grid: Grid,
    corpus: &Corpus,
    validation: &Corpus,
    config: &TeacherTraining,
    seed: u64,
    device: &Device,
    run: &RunFolder,
    resume: bool,
    interrupt: &Interrupt,
) -> Result<Teacher, RunError> {
    let learner = learner(grid, corpus, validation, config, seed, device);
    let train_config = TrainConfig {
        epochs: config.epochs,
        learning_rate: config.learning_rate,
        lr_schedule: config.lr_schedule,
        weight_decay: config.weight_decay,
        ema_decay: config.ema_decay,
        seed,
    };
    let Some(lora) = config.lora else {
        return fit(&learner, model, train_config, run, resume, interrupt);
    };
    let model = fit(
        &learner,
        lora.adapt(model),
        train_config,
        run,
        resume,
        interrupt,
    )?;
    let merged = model.valid().materialize();
    run.save_model(NAME, &merged)?;
    Ok(merged)
}

/// What a teacher whose windows lie on `grid` learns from.
#[must_use]
pub fn learner<'a>(
    grid: Grid,
    corpus: &'a Corpus,
    validation: &'a Corpus,
    config: &'a TeacherTraining,
    seed: u64,
    device: &'a Device,
) -> TeacherLearner<'a> {
    TeacherLearner {
        grid,
        corpus,
        validation,
        config,
        examples: examples(corpus, config.stride, grid.window, &config.tasks),
        checks: examples(validation, config.stride, grid.window, &config.tasks),
        seed,
        device,
    }
}

impl Learner for TeacherLearner<'_> {
    type Model = Teacher;
    type Item = Vec<Example>;
    type Shard = (Batch, ChaCha8Rng);

    fn name(&self) -> &'static str {
        if self.config.lora.is_some() {
            ADAPTED
        } else {
            NAME
        }
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Self::Item> {
        let mut order = self.examples.clone();
        order.shuffle(rng);
        order
            .chunks(self.config.batch)
            .map(<[Example]>::to_vec)
            .collect()
    }

    fn steps(&self) -> usize {
        // As in the reference, the last, short batch is trained on but not counted.
        self.examples.len() / self.config.batch
    }

    fn shards(&self, item: &Self::Item, rng: &mut ChaCha8Rng) -> Vec<Self::Shard> {
        let variation = self.config.augmentation.as_ref();
        let mut shards: Vec<Self::Shard> = item
            .chunks(item.len().div_ceil(SHARDS))
            .map(|part| {
                let batch = batch(self.corpus, part, self.grid, variation, rng, self.device);
                (batch, ChaCha8Rng::from_rng(rng))
            })
            .collect();
        // Means are over the whole batch, as if it had been computed in one piece.
        let emg_cells = shards.iter().map(|(batch, _)| batch.emg_cells).sum();
        let intent_samples = shards.iter().map(|(batch, _)| batch.intent_samples).sum();
        for (batch, _) in &mut shards {
            (batch.emg_cells, batch.intent_samples) = (emg_cells, intent_samples);
        }
        shards
    }

    fn loss(&self, model: &Teacher, (batch, rng): Self::Shard) -> (Tensor<1>, Vec<WeightedMetric>) {
        let (emg, intent) = losses(&model.forward_dropping(batch.input.clone(), rng), &batch);
        let total = emg.clone() + intent.clone();
        (total, parts(emg, intent, &batch))
    }

    fn validate(&self, model: &Teacher) -> (f64, Vec<WeightedMetric>) {
        let device = self.device.clone().inner();
        // The same masks every epoch, so that the losses of two epochs can be compared.
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let (mut emg_sum, mut intent_sum) = (Sum::default(), Sum::default());
        for examples in self.checks.chunks(self.config.batch) {
            let batch = batch(
                self.validation,
                examples,
                self.grid,
                None,
                &mut rng,
                &device,
            );
            let (emg, intent) = losses(&model.forward(batch.input.clone()), &batch);
            emg_sum.add(read_back(emg)[0], batch.emg_cells);
            intent_sum.add(read_back(intent)[0], batch.intent_samples);
        }
        let accuracy = self.accuracy(model, &device);
        let parts = vec![
            WeightedMetric {
                name: "emg",
                mean: emg_sum.mean(),
                weight: 1.0,
            },
            WeightedMetric {
                name: "intent",
                mean: intent_sum.mean(),
                weight: 1.0,
            },
            WeightedMetric {
                name: "accuracy",
                mean: accuracy,
                weight: 1.0,
            },
        ];
        (emg_sum.mean() + intent_sum.mean(), parts)
    }
}

impl TeacherLearner<'_> {
    /// Share of labelled samples that the model names rightly when it sees EMG alone.
    fn accuracy(&self, model: &Teacher, device: &Device) -> f64 {
        let classes = self.validation.vocabulary.classes();
        let mut windows: Vec<_> = self.checks.iter().map(|example| example.window).collect();
        windows.dedup();
        let mut right = Sum::default();
        for windows in windows.chunks(self.config.batch) {
            let mut emg = Vec::new();
            let mut labels = Vec::new();
            for window in windows {
                let stream = &self.validation.streams[window.stream];
                let range = window.start..window.start + self.grid.window;
                Variation::NONE.write(&stream.emg[range.clone()], &mut emg);
                labels.extend_from_slice(&stream.labels[range]);
            }
            let logits = read_back(
                model
                    .forward(inference_input(emg, self.grid, classes, device))
                    .intent,
            );
            for (row, label) in logits.chunks_exact(classes + 1).zip(labels) {
                if let Some(intent) = label {
                    right.add(
                        f32::from(u8::from(best_class(&row[..classes]) == intent.class())),
                        1,
                    );
                }
            }
        }
        right.mean()
    }
}

/// EMG and intent loss of a batch, each a mean over the masked cells of the whole batch; a term
/// without masked cells is 0. Their sum is trained on.
#[must_use]
pub fn losses(output: &TeacherOutput, batch: &Batch) -> (Tensor<1>, Tensor<1>) {
    let difference = output.emg.clone() - batch.emg_target.clone();
    let emg = (difference.square() * batch.input.emg_mask.clone()).sum()
        * (1.0 / batch.emg_cells.max(1) as f64);
    let intent = cross_entropy(
        output.intent.clone(),
        batch.intent_target.clone().unsqueeze_dim(2),
        batch.intent_weight.clone().unsqueeze_dim(2),
        batch.intent_samples as f64,
    );
    (emg, intent)
}

fn parts(emg: Tensor<1>, intent: Tensor<1>, batch: &Batch) -> Vec<WeightedMetric> {
    let mean = |loss: Tensor<1>| f64::from(read_back(loss)[0]);
    vec![
        WeightedMetric {
            name: "emg",
            mean: mean(emg),
            weight: batch.emg_cells as f64,
        },
        WeightedMetric {
            name: "intent",
            mean: mean(intent),
            weight: batch.intent_samples as f64,
        },
    ]
}

/// A mean over cells that come batch by batch.
#[derive(Default)]
struct Sum {
    total: f64,
    cells: f64,
}

impl Sum {
    fn add(&mut self, mean: f32, cells: usize) {
        self.total += f64::from(mean) * cells as f64;
        self.cells += cells as f64;
    }

    fn mean(&self) -> f64 {
        self.total / self.cells.max(1.0)
    }
}
