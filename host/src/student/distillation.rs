//! Trains a student: what the teacher says about the newest six patches, and the labels.

use burn::tensor::activation::{log_softmax, softmax};
use burn::tensor::{Device, Int, Tensor, TensorData};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use shared::intent::Intent;
use shared::units::{CHANNELS, LOOK_BACK, PATCH, WINDOW_PATCHES};

use super::model::Student;
use crate::dataset::corpus::{Corpus, patch_labels};
use crate::dataset::lead_in::padded;
use crate::execution::interrupt::Interrupt;
use crate::execution::run_folder::{RunError, RunFolder};
use crate::training::augmentation::{Augmentation, Variation};
use crate::training::fit::{Learner, SHARDS, TrainConfig, WeightedMetric, fit};
use crate::training::loss::cross_entropy;
use crate::training::schedule::LrSchedule;
use crate::training::tensor::read_back;
use shared::model::LookBackLogits;

/// Name of the run's files: `student.bpk` is the checkpoint of the lowest validation loss.
pub const NAME: &str = "student";
/// Name of the files of a student that has learnt from the labels alone, beside the one that had a teacher.
pub const LABELS_ONLY: &str = "student-alone";

/// How a student is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Distillation {
    /// Epochs; each ends with a validation.
    pub epochs: usize,
    /// Steps of an epoch.
    pub steps: usize,
    /// Sequences a step.
    pub batch: usize,
    /// Patches of a sequence; longer than a window.
    pub patches: usize,
    /// Peak learning rate.
    pub learning_rate: f64,
    /// Share of the steps that the rate rises.
    pub warm_up: f64,
    /// Decoupled weight decay.
    pub weight_decay: f32,
    /// Decay of the exponential moving average of the weights that is saved; 0 saves those of the last step.
    #[serde(default)]
    pub ema_decay: f64,
    /// Share of the teacher's word against the labels', 0..=1; 0 trains without a teacher.
    pub teacher_share: f64,
    /// Softening of both sides before they are compared.
    pub temperature: f64,
    /// Variations of the student's input; the teacher always sees the EMG as recorded.
    pub augmentation: Option<Augmentation>,
}

/// A stream cut into patches, with a full window in front and the teacher's word on every patch.
struct Lesson {
    emg: Vec<[u8; CHANNELS]>,
    labels: Vec<Option<Intent>>,
    teacher: Option<Vec<LookBackLogits>>,
}

impl Lesson {
    fn patches(&self) -> usize {
        self.labels.len()
    }
}

/// A student's training, batch by batch.
pub struct StudentLearner<'a> {
    name: &'static str,
    config: &'a Distillation,
    /// Patches of context before a patch's answer counts.
    context: usize,
    classes: usize,
    lessons: Vec<Lesson>,
    checks: Vec<Lesson>,
    device: &'a Device,
}

/// Trains a student on a corpus and the teacher's rows over it, one list a stream; `name` is [`NAME`]
/// or [`LABELS_ONLY`].
///
/// # Errors
/// When the folder cannot be written or the user interrupts.
#[expect(clippy::too_many_arguments, reason = "a run is what these say")]
pub fn train(
    name: &'static str,
    model: Student,
    span: usize,
    corpus: &Corpus,
    teacher: Option<Vec<Vec<LookBackLogits>>>,
    validation: &Corpus,
    config: &Distillation,
    seed: u64,
    device: &Device,
    run: &RunFolder,
    resume: bool,
    interrupt: &Interrupt,
) -> Result<Student, RunError> {
    let learner = StudentLearner {
        name,
        ..learner(span, corpus, teacher, validation, config, device)
    };
    let train_config = TrainConfig {
        epochs: config.epochs,
        learning_rate: config.learning_rate,
        lr_schedule: LrSchedule::WarmUp(config.warm_up),
        weight_decay: config.weight_decay,
        ema_decay: config.ema_decay,
        seed,
    };
    fit(&learner, model, train_config, run, resume, interrupt)
}

/// What a student learns from.
#[must_use]
pub fn learner<'a>(
    span: usize,
    corpus: &Corpus,
    teacher: Option<Vec<Vec<LookBackLogits>>>,
    validation: &Corpus,
    config: &'a Distillation,
    device: &'a Device,
) -> StudentLearner<'a> {
    StudentLearner {
        name: NAME,
        config,
        context: span,
        classes: corpus.vocabulary.classes(),
        lessons: lessons(corpus, teacher),
        checks: lessons(validation, None),
        device,
    }
}

fn lessons(corpus: &Corpus, teacher: Option<Vec<Vec<LookBackLogits>>>) -> Vec<Lesson> {
    let mut teacher = teacher.map(Vec::into_iter);
    corpus
        .streams
        .iter()
        .map(|stream| {
            let own = patch_labels(&stream.labels);
            let whole = own.len() * PATCH;
            let unknown = std::iter::repeat_n(None, WINDOW_PATCHES);
            Lesson {
                emg: padded(&stream.emg[..whole]),
                labels: unknown.chain(own).collect(),
                teacher: teacher.as_mut().map(|rows| rows.next().unwrap_or_default()),
            }
        })
        .filter(|lesson| lesson.patches() > WINDOW_PATCHES)
        .collect()
}

/// A piece of a lesson.
#[derive(Clone, Copy)]
pub struct Excerpt {
    lesson: usize,
    start: usize,
    variation: Variation,
}

/// A batch: what the student hears, and what it should have answered.
pub struct Questions {
    emg: Tensor<3>,
    label: Tensor<4, Int>,
    labelled: Tensor<3>,
    teacher: Option<(Tensor<4>, Tensor<3>)>,
    /// Labelled answers.
    answers: f64,
    /// Answers that the teacher gives too.
    taught: f64,
}

impl StudentLearner<'_> {
    fn excerpt(&self, rng: &mut ChaCha8Rng, total: usize) -> Excerpt {
        // A place drawn over all patches, so that long streams are drawn more often.
        let mut place = rng.random_range(0..total);
        let mut lesson = 0;
        while place >= self.lessons[lesson].patches() {
            place -= self.lessons[lesson].patches();
            lesson += 1;
        }
        let room = self.lessons[lesson]
            .patches()
            .saturating_sub(self.config.patches);
        let variation = match &self.config.augmentation {
            Some(augmentation) => augmentation.draw(rng),
            None => Variation::NONE,
        };
        Excerpt {
            lesson,
            start: rng.random_range(0..=room),
            variation,
        }
    }

    /// Tensors of a batch of excerpts of `patches` patches; a short stream's end is left blank.
    fn questions(
        &self,
        lessons: &[Lesson],
        excerpts: &[Excerpt],
        patches: usize,
        device: &Device,
    ) -> Questions {
        let b = excerpts.len();
        let classes = self.classes;
        let mut emg = Vec::with_capacity(b * patches * PATCH * CHANNELS);
        let mut label = vec![0_i32; b * patches * LOOK_BACK];
        let mut labelled = vec![0.0_f32; b * patches * LOOK_BACK];
        let mut logits = vec![0.0_f32; b * patches * LOOK_BACK * classes];
        let mut taught = vec![0.0_f32; b * patches * LOOK_BACK];
        let (mut answers, mut taught_answers) = (0.0, 0.0);
        for (row, excerpt) in excerpts.iter().enumerate() {
            let lesson = &lessons[excerpt.lesson];
            let end = (excerpt.start + patches).min(lesson.patches());
            excerpt
                .variation
                .write(&lesson.emg[excerpt.start * PATCH..end * PATCH], &mut emg);
            emg.resize((row + 1) * patches * PATCH * CHANNELS, 0.0);
            // Answers count once there is context enough, and only about the stream itself.
            for patch in excerpt.start + self.context..end {
                for back in 0..LOOK_BACK {
                    let Some(about) = patch
                        .checked_sub(back)
                        .filter(|&about| about >= WINDOW_PATCHES)
                    else {
                        continue;
                    };
                    let cell = (row * patches + patch - excerpt.start) * LOOK_BACK + back;
                    if let Some(intent) = lesson.labels[about] {
                        label[cell] = intent.class() as i32;
                        labelled[cell] = 1.0;
                        answers += 1.0;
                    }
                    if let Some(rows) = &lesson.teacher {
                        taught[cell] = 1.0;
                        taught_answers += 1.0;
                        logits[cell * classes..(cell + 1) * classes]
                            .copy_from_slice(&rows[patch - WINDOW_PATCHES][back][..classes]);
                    }
                }
            }
        }
        let cells = [b, patches, LOOK_BACK];
        let has_teacher = lessons.iter().any(|lesson| lesson.teacher.is_some());
        Questions {
            emg: Tensor::from_data(TensorData::new(emg, [b, patches, PATCH * CHANNELS]), device),
            label: Tensor::from_data(TensorData::new(label, [b, patches, LOOK_BACK, 1]), device),
            labelled: Tensor::from_data(TensorData::new(labelled, cells), device),
            teacher: has_teacher.then(|| {
                (
                    Tensor::from_data(
                        TensorData::new(logits, [b, patches, LOOK_BACK, classes]),
                        device,
                    ),
                    Tensor::from_data(TensorData::new(taught, cells), device),
                )
            }),
            answers,
            taught: taught_answers,
        }
    }

    /// Cross entropy against the labels, mean over labelled answers.
    fn label_loss(logits: &Tensor<4>, questions: &Questions) -> Tensor<1> {
        cross_entropy(
            logits.clone(),
            questions.label.clone(),
            questions.labelled.clone().unsqueeze_dim(3),
            questions.answers,
        )
    }

    /// Divergence from the softened teacher, mean over its answers, scaled by the temperature's
    /// square so that its gradient keeps its size.
    fn teacher_loss(
        &self,
        logits: &Tensor<4>,
        (teacher, taught): &(Tensor<4>, Tensor<3>),
        answers: f64,
    ) -> Tensor<1> {
        let cold = 1.0 / self.config.temperature;
        let target = softmax(teacher.clone() * cold, 3);
        let target_log = log_softmax(teacher.clone() * cold, 3);
        let divergence = (target * (target_log - log_softmax(logits.clone() * cold, 3)))
            .sum_dim(3)
            .squeeze_dim::<3>(3);
        (divergence * taught.clone()).sum() * (self.config.temperature.powi(2) / answers.max(1.0))
    }
}

impl Learner for StudentLearner<'_> {
    type Model = Student;
    type Item = Vec<Excerpt>;
    type Shard = Questions;

    fn name(&self) -> &'static str {
        self.name
    }

    fn epoch(&self, rng: &mut ChaCha8Rng) -> Vec<Vec<Excerpt>> {
        let total = self.lessons.iter().map(Lesson::patches).sum();
        (0..self.config.steps)
            .map(|_| {
                (0..self.config.batch)
                    .map(|_| self.excerpt(rng, total))
                    .collect()
            })
            .collect()
    }

    fn steps(&self) -> usize {
        self.config.steps
    }

    fn shards(&self, item: &Self::Item, _: &mut ChaCha8Rng) -> Vec<Questions> {
        let mut shards: Vec<Questions> = item
            .chunks(item.len().div_ceil(SHARDS))
            .map(|part| self.questions(&self.lessons, part, self.config.patches, self.device))
            .collect();
        // Means are over the whole batch, as if it had been computed in one piece.
        let answers = shards.iter().map(|questions| questions.answers).sum();
        let taught = shards.iter().map(|questions| questions.taught).sum();
        for questions in &mut shards {
            (questions.answers, questions.taught) = (answers, taught);
        }
        shards
    }

    fn loss(&self, model: &Student, questions: Questions) -> (Tensor<1>, Vec<WeightedMetric>) {
        let logits = model.forward(questions.emg.clone());
        let label = Self::label_loss(&logits, &questions);
        let part = |name, loss: &Tensor<1>| WeightedMetric {
            name,
            mean: f64::from(read_back(loss.clone())[0]),
            weight: 1.0,
        };
        let mut parts = vec![part("label", &label)];
        let share = self.config.teacher_share;
        let total = match &questions.teacher {
            Some(teacher) if share > 0.0 => {
                let divergence = self.teacher_loss(&logits, teacher, questions.taught);
                parts.push(part("teacher", &divergence));
                divergence * share + label * (1.0 - share)
            }
            _ => label,
        };
        (total, parts)
    }

    fn validate(&self, model: &Student) -> (f64, Vec<WeightedMetric>) {
        let device = self.device.clone().inner();
        let (mut loss, mut answers) = (0.0, 0.0);
        let mut right = [0.0; LOOK_BACK];
        let mut asked = [0.0; LOOK_BACK];
        for lesson in 0..self.checks.len() {
            let fresh = self.config.patches - self.context;
            let last = self.checks[lesson].patches().saturating_sub(self.context);
            let excerpts: Vec<_> = (0..last)
                .step_by(fresh)
                .map(|start| Excerpt {
                    lesson,
                    start,
                    variation: Variation::NONE,
                })
                .collect();
            for excerpts in excerpts.chunks(self.config.batch) {
                let questions =
                    self.questions(&self.checks, excerpts, self.config.patches, &device);
                let logits = model.forward(questions.emg.clone());
                loss += f64::from(read_back(Self::label_loss(&logits, &questions))[0])
                    * questions.answers;
                answers += questions.answers;
                let hits = logits
                    .argmax(3)
                    .equal(questions.label)
                    .float()
                    .squeeze_dim::<3>(3);
                let hits = read_back(hits * questions.labelled.clone());
                for (cell, (hit, counts)) in
                    hits.iter().zip(read_back(questions.labelled)).enumerate()
                {
                    right[cell % LOOK_BACK] += f64::from(*hit);
                    asked[cell % LOOK_BACK] += f64::from(counts);
                }
            }
        }
        let loss = loss / f64::max(answers, 1.0);
        let share = |row: usize| right[row] / f64::max(asked[row], 1.0);
        let parts = vec![
            WeightedMetric {
                name: "label",
                mean: loss,
                weight: 1.0,
            },
            WeightedMetric {
                name: "newest patch",
                mean: share(0),
                weight: 1.0,
            },
            WeightedMetric {
                name: "oldest patch",
                mean: share(LOOK_BACK - 1),
                weight: 1.0,
            },
        ];
        (loss, parts)
    }
}
