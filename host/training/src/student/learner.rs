//! A student's training, batch by batch: sequences, losses, validation.

use burn::tensor::activation::{log_softmax, softmax};
use burn::tensor::{Device, Tensor};
use rand_chacha::ChaCha8Rng;
use shared::model::LookBackLogits;
use shared::units::LOOK_BACK;

use super::batch::{Batch, BatchShape};
use super::ensemble::Ensemble;
use super::model::Student;
use super::sequence::{Excerpt, Sequence, sequences};
use crate::optimization::learner::{Learner, WeightedMean, WeightedMetric, shards};
use crate::optimization::loss::cross_entropy;
use crate::optimization::read_back;
use presets::augmentation::Variation;
use presets::distillation::Distillation;
use recordings::corpus::Corpus;

/// Source of a student's soft targets.
pub enum Teaching<'a> {
    /// No soft targets: the student learns from the labels alone.
    Labels,
    /// Teacher: its logits at every patch of the recordings, stream by stream.
    Teacher(Vec<Vec<LookBackLogits>>),
    /// The model itself before it is tuned, as a teacher of all but movement outside the vocabulary, which is learnt from the labels
    /// alone.
    Own(Vec<Vec<LookBackLogits>>),
    /// Ensemble of students, which computes targets for each batch.
    Ensemble(&'a Ensemble),
}

/// Training problem of a student.
pub struct StudentLearner<'a> {
    name: &'static str,
    config: &'a Distillation,
    shape: BatchShape,
    sequences: Vec<Sequence>,
    validation_sequences: Vec<Sequence>,
    ensemble: Option<&'a Ensemble>,
    device: &'a Device,
}

impl<'a> StudentLearner<'a> {
    /// Builds the sequences of the corpora, for a student whose files are called `name` and whose layers attend to `span`
    /// patches.
    pub fn new(
        name: &'static str,
        span: usize,
        corpus: &Corpus,
        teaching: Teaching<'a>,
        validation: &Corpus,
        config: &'a Distillation,
        device: &'a Device,
    ) -> Self {
        let teacher_on_other = !matches!(teaching, Teaching::Own(_));
        let (soft_targets, ensemble) = match teaching {
            Teaching::Labels => (None, None),
            Teaching::Teacher(logits) | Teaching::Own(logits) => (Some(logits), None),
            Teaching::Ensemble(ensemble) => (None, Some(ensemble)),
        };
        Self {
            name,
            config,
            shape: BatchShape {
                patches: config.patches,
                context: span,
                outputs: corpus.vocabulary.classes() + usize::from(corpus.other),
            },
            sequences: sequences(corpus, soft_targets, teacher_on_other),
            validation_sequences: sequences(validation, None, true),
            ensemble,
            device,
        }
    }

    /// Excerpts that cover the targets of a whole sequence, each once, without variations.
    fn covering(&self, sequence: usize) -> Vec<Excerpt> {
        let new_patches = self.shape.patches - self.shape.context;
        let end = self.validation_sequences[sequence]
            .patches()
            .saturating_sub(self.shape.context);
        (0..end)
            .step_by(new_patches)
            .map(|start| Excerpt {
                sequence,
                start,
                variation: Variation::NONE,
            })
            .collect()
    }
}

/// Cross entropy with the labels, as a mean over labelled outputs.
fn label_loss(logits: &Tensor<4>, batch: &Batch) -> Tensor<1> {
    cross_entropy(
        logits.clone(),
        batch.targets.clone(),
        batch.label_mask.clone().unsqueeze_dim(3),
        batch.labelled,
    )
}

/// Kullback-Leibler divergence from a teacher's distribution at a temperature, as a mean over distilled outputs.
///
/// The factor of the squared temperature keeps the scale of its gradient (Hinton et al., arXiv 1503.02531).
fn distillation_loss(
    logits: &Tensor<4>,
    teacher: &Tensor<4>,
    batch: &Batch,
    temperature: f64,
) -> Tensor<1> {
    let inverse = 1.0 / temperature;
    let target = softmax(teacher.clone() * inverse, 3);
    let target_log = log_softmax(teacher.clone() * inverse, 3);
    let divergence = (target * (target_log - log_softmax(logits.clone() * inverse, 3)))
        .sum_dim(3)
        .squeeze_dim::<3>(3);
    (divergence * batch.distillation_mask.clone()).sum()
        * (temperature.powi(2) / batch.distilled.max(1.0))
}

impl Learner for StudentLearner<'_> {
    type Model = Student;
    type Item = Vec<Excerpt>;
    type Shard = Batch;

    fn name(&self) -> &'static str {
        self.name
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Vec<Excerpt>> {
        (0..self.config.steps)
            .map(|_| {
                (0..self.config.batch)
                    .map(|_| Excerpt::draw(&self.sequences, self.config, rng))
                    .collect()
            })
            .collect()
    }

    fn steps(&self) -> usize {
        self.config.steps
    }

    fn shards(&self, item: &Self::Item, _: &mut ChaCha8Rng) -> Vec<Batch> {
        let batch = |part: &[Excerpt]| Batch::new(&self.sequences, part, self.shape, self.device);
        let mut shards = shards(item, batch);
        // Losses are means over the whole batch, as if it had one part.
        let labelled = shards.iter().map(|batch| batch.labelled).sum();
        let distilled = shards.iter().map(|batch| batch.distilled).sum();
        for batch in &mut shards {
            batch.labelled = labelled;
            batch.distilled = distilled;
        }
        shards
    }

    fn loss(&self, model: &Student, mut batch: Batch) -> (Tensor<1>, Vec<WeightedMetric>) {
        let logits = model.forward(batch.emg.clone());
        let label = label_loss(&logits, &batch);
        let mut metrics = vec![WeightedMetric::of_loss("label", &label, 1.0)];
        let share = self.config.teacher_share;
        let teacher = match self.ensemble {
            Some(ensemble) => Some(ensemble.logits(batch.emg.clone())),
            None => batch.soft_targets.take(),
        };
        let total = match teacher {
            Some(teacher) if share > 0.0 => {
                let temperature = self.config.temperature;
                let divergence = distillation_loss(&logits, &teacher, &batch, temperature);
                metrics.push(WeightedMetric::of_loss("teacher", &divergence, 1.0));
                divergence * share + label * (1.0 - share)
            }
            _ => label,
        };
        (total, metrics)
    }

    fn validate(&self, model: &Student) -> (f64, Vec<(&'static str, f64)>) {
        let device = self.device.clone().inner();
        let mut loss = WeightedMean::default();
        let mut correct = [WeightedMean::default(); LOOK_BACK];
        for sequence in 0..self.validation_sequences.len() {
            for excerpts in self.covering(sequence).chunks(self.config.batch) {
                let batch = Batch::new(&self.validation_sequences, excerpts, self.shape, &device);
                let logits = model.forward(batch.emg.clone());
                loss.add(read_back(label_loss(&logits, &batch))[0], batch.labelled);
                let hits = logits
                    .argmax(3)
                    .equal(batch.targets)
                    .float()
                    .squeeze_dim::<3>(3);
                let mask = read_back(batch.label_mask);
                for (output, (hit, weight)) in read_back(hits).into_iter().zip(mask).enumerate() {
                    correct[output % LOOK_BACK].add(hit, f64::from(weight));
                }
            }
        }
        let metrics = vec![
            ("label", loss.mean()),
            ("newest patch", correct[0].mean()),
            ("oldest patch", correct[LOOK_BACK - 1].mean()),
        ];
        (loss.mean(), metrics)
    }
}
