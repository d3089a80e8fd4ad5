//! A teacher's training, batch by batch: examples, losses, validation.

use burn::module::{Lora, Module as _, ParamGroup};
use burn::tensor::{Device, Tensor};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::batch::Batch;
use super::model::{Teacher, TeacherInput, TeacherOutput};
use super::window::{Example, WindowShape, examples};
use crate::optimization::fit::{Training, fit};
use crate::optimization::learner::{Learner, WeightedMean, WeightedMetric, shards};
use crate::optimization::loss::cross_entropy;
use crate::optimization::{best_class, initial, read_back};
use crate::weights::save_model;
use execution::run_folder::RunError;
use presets::augmentation::Variation;
use presets::teacher::{ADAPTED, LoraConfig, NAME, TeacherTraining};
use recordings::corpus::Corpus;

/// Training problem of a teacher.
pub struct TeacherLearner<'a> {
    shape: WindowShape,
    corpus: &'a Corpus,
    validation: &'a Corpus,
    config: &'a TeacherTraining,
    examples: Vec<Example>,
    validation_examples: Vec<Example>,
    seed: u64,
    device: &'a Device,
}

impl<'a> TeacherLearner<'a> {
    /// Collects every window of the corpora, once per task, for a teacher of this window shape.
    pub fn new(
        shape: WindowShape,
        corpus: &'a Corpus,
        validation: &'a Corpus,
        config: &'a TeacherTraining,
        seed: u64,
        device: &'a Device,
    ) -> Self {
        let of = |corpus| examples(corpus, config.stride, shape.window, &config.tasks);
        Self {
            shape,
            corpus,
            validation,
            config,
            examples: of(corpus),
            validation_examples: of(validation),
            seed,
            device,
        }
    }

    /// Trains a model and saves it in the run folder, LoRA adapters merged.
    pub(crate) fn train(
        &self,
        model: Teacher,
        training: &Training<'_>,
    ) -> Result<Teacher, RunError> {
        let config = self.config.train_config(self.seed);
        let Some(lora) = self.config.lora else {
            return fit(self, model, config, training);
        };
        let model = initial(self.seed, self.device, || adapt(lora, model));
        let adapted = fit(self, model, config, training)?;
        let merged = adapted.valid().materialize();
        save_model(training.run, NAME, training.made_from, &merged)?;
        Ok(merged)
    }

    /// Share of labelled samples that the model classifies correctly from EMG alone.
    fn accuracy(&self, model: &Teacher, device: &Device) -> f64 {
        let classes = self.validation.vocabulary.classes();
        let mut windows: Vec<_> = self
            .validation_examples
            .iter()
            .map(|example| example.window)
            .collect();
        windows.dedup();
        let mut correct = WeightedMean::default();
        for windows in windows.chunks(self.config.batch) {
            let mut emg = Vec::new();
            let mut labels = Vec::new();
            for window in windows {
                let stream = &self.validation.streams[window.stream];
                let range = window.start..window.start + self.shape.window;
                Variation::NONE.write(&stream.emg[range.clone()], &mut emg);
                labels.extend_from_slice(&stream.labels[range]);
            }
            let input = TeacherInput::for_inference(emg, self.shape, classes, device);
            let logits = read_back(model.forward(input).intent);
            for (logits, label) in logits.chunks_exact(classes + 1).zip(labels) {
                if let Some(intent) = label {
                    let hit = best_class(&logits[..classes]) == intent.class();
                    correct.add(f32::from(u8::from(hit)), 1.0);
                }
            }
        }
        correct.mean()
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
        let augmentation = self.config.augmentation.as_ref();
        let mut shards = shards(item, |part| {
            let batch = Batch::new(
                self.corpus,
                part,
                self.shape,
                augmentation,
                rng,
                self.device,
            );
            (batch, ChaCha8Rng::from_rng(rng))
        });
        // Losses are means over the whole batch, as if it had one part.
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
        let metrics = vec![
            WeightedMetric::of_loss("emg", &emg, batch.emg_cells as f64),
            WeightedMetric::of_loss("intent", &intent, batch.intent_samples as f64),
        ];
        (total, metrics)
    }

    fn validate(&self, model: &Teacher) -> (f64, Vec<(&'static str, f64)>) {
        let device = self.device.clone().inner();
        // The same masks for every epoch, so that the losses of two epochs can be compared.
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let (mut emg_loss, mut intent_loss) = (WeightedMean::default(), WeightedMean::default());
        for examples in self.validation_examples.chunks(self.config.batch) {
            let batch = Batch::new(
                self.validation,
                examples,
                self.shape,
                None,
                &mut rng,
                &device,
            );
            let (emg, intent) = losses(&model.forward(batch.input.clone()), &batch);
            emg_loss.add(read_back(emg)[0], batch.emg_cells as f64);
            intent_loss.add(read_back(intent)[0], batch.intent_samples as f64);
        }
        let metrics = vec![
            ("emg", emg_loss.mean()),
            ("intent", intent_loss.mean()),
            ("accuracy", self.accuracy(model, &device)),
        ];
        (emg_loss.mean() + intent_loss.mean(), metrics)
    }
}

/// Computes the EMG loss and the intent loss of a batch, which are added for training. Each is a mean over the masked
/// positions of the whole batch, 0 where nothing is masked.
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

/// Adds adapters of low rank (LoRA, arXiv 2106.09685) to a model, which alone are trained; at first they do not change its outputs.
fn adapt(lora: LoraConfig, model: Teacher) -> Teacher {
    let mut paths = vec!["intent_head.weight".to_owned()];
    for layer in 0..model.depth() {
        paths.extend(["linear1", "linear2"].map(|name| format!("layers.{layer}.{name}.weight")));
    }
    let lora = Lora::new(lora.rank, lora.alpha).set_param_group(ParamGroup::from_paths(paths));
    model.apply_lora(lora)
}
