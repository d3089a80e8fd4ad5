//! A few steps of training on the GPU backend and on the CPU's: the same losses, the same weights.
//!
//! Both start from the same weights, drawn by one of them: another backend draws others from the same seed. All that is random
//! afterwards comes from a seed on the host, the order of the windows, masks, augmentation, and dropout as a hash; so both see
//! the same batches. They differ in the order of sums: the CPU backend runs fused operations, the GPU Burn's.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use burn::module::{Module, ModuleVisitor, Param};
use burn::optim::GradientsParams;
use burn::tensor::{Device, Tensor};
use myointent_tests::skip;
use presets::Preset;
use presets::masking::Task;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use recordings::corpus::{Corpus, Stream};
use recordings::synthetic::{self, SynthOptions};
use shared::intent::Vocabulary;
use shared::model::LookBackLogits;
use shared::units::PATCH;
use training::backend::Backend;
use training::optimization::learner::{Learner, WeightedMetric};
use training::optimization::optimizer::{gradients, optimizer};
use training::optimization::read_back;
use training::student::learner::{StudentLearner, Teaching};
use training::student::model::Student;
use training::teacher::learner::TeacherLearner;
use training::teacher::model::Teacher;

/// Steps that are compared.
const STEPS: usize = 4;
const SEED: u64 = 42;
const LEARNING_RATE: f64 = 1e-3;
const WEIGHT_DECAY: f32 = 0.01;

// Measured on lavapipe: losses 3.1e-7 apart, gradients 1.5e-6, changes of the weights 5.6e-6, a few roundings of f32. The
// tolerances leave room for another driver's order of sums, and are below what another function gives: with the derivative of
// GELU's approximation by tanh the gradients are 2.7e-4 apart.
/// Largest relative difference of a loss.
const LOSS: f64 = 1e-5;
/// Largest distance of a parameter's gradients, as a share of their norm.
const GRADIENT: f64 = 3e-5;
/// Largest distance of a parameter's values after the steps, as a share of how far they moved. AdamW divides a gradient by its size,
/// the smallest and least exact ones too.
const WEIGHT: f64 = 1e-3;

/// A model's parameters by their path.
type Parameters = BTreeMap<String, Vec<f32>>;

/// Results of a training.
struct Trained {
    before: Parameters,
    after: Parameters,
    /// Gradients of the first step.
    gradients: Parameters,
    /// The parts of the loss at each step.
    losses: Vec<Vec<WeightedMetric>>,
    /// The loss of the validation after the last step.
    validation: f64,
    /// Time of a step, without the first one, in which a GPU's kernels are compiled.
    step: Duration,
}

/// Collects a model's parameters, or their gradients.
#[derive(Default)]
struct Collect<'a> {
    gradients: Option<&'a GradientsParams>,
    path: Vec<String>,
    found: Parameters,
}

impl ModuleVisitor for Collect<'_> {
    fn enter_module(&mut self, name: &str, _: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _: &str, _: &str) {
        self.path.pop();
    }

    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let tensor = match self.gradients {
            Some(gradients) => gradients.get(param.id).expect("a gradient of everything"),
            None => param.val(),
        };
        self.found.insert(self.path.join("."), read_back(tensor));
    }
}

fn collect(model: &impl Module, gradients: Option<&GradientsParams>) -> Parameters {
    let mut collect = Collect {
        gradients,
        ..Collect::default()
    };
    model.visit(&mut collect);
    collect.found
}

/// The GPU backend's device; without an adapter, books the test as skipped.
pub fn gpu() -> Option<Device> {
    let device = Backend::Wgpu.device();
    let device = device.map_err(|error| skip(&error.to_string())).ok()?;
    Some(device.autodiff())
}

/// Trains from a model's weights, on the learner's device.
fn train<L: Learner>(learner: &L, mut model: L::Model) -> Trained {
    let before = collect(&model, None);
    let mut first = None;
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let mut adam = optimizer(WEIGHT_DECAY);
    let mut losses = Vec::new();
    let items = learner.epoch(&mut rng);
    assert!(items.len() >= STEPS, "{} steps", items.len());
    let mut second = Instant::now();
    for item in items.into_iter().take(STEPS) {
        let (gradients, metrics) = gradients(learner, &model, learner.shards(&item, &mut rng));
        first.get_or_insert_with(|| collect(&model, Some(&gradients)));
        model = adam.step(LEARNING_RATE, model, gradients);
        losses.push(metrics);
        if losses.len() == 1 {
            // Reading waits for the device.
            drop(collect(&model, None));
            second = Instant::now();
        }
    }
    let after = collect(&model, None);
    let step = second.elapsed() / (STEPS as u32 - 1);
    Trained {
        before,
        after,
        step,
        gradients: first.expect("there is a step"),
        losses,
        validation: learner.validate(&model.valid()).0,
    }
}

/// A recording with labels, and one without.
fn corpus() -> Corpus {
    let mut streams = Vec::new();
    for recording in synthetic::generate(&SynthOptions {
        subjects: 2,
        recordings: 1,
        seconds: 30,
        ..SynthOptions::default()
    }) {
        let mut labels = recording.labels_in(Vocabulary::Three);
        if !streams.is_empty() {
            labels.fill(None);
        }
        streams.push(Stream::new(recording.samples, labels));
    }
    Corpus {
        vocabulary: Vocabulary::Three,
        other: false,
        streams,
    }
}

fn distance(a: &[f32], b: &[f32]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

fn norm(values: &[f32]) -> f64 {
    values
        .iter()
        .map(|v| f64::from(*v).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Without the biases of the keys: they add the same to all scores of a query, so their gradient is 0. What rounding leaves
/// of it AdamW divides by its own size.
fn without_keys(name: &str, values: &[f32]) -> Vec<f32> {
    let mut values = values.to_vec();
    if name.ends_with("qkv.bias") {
        let width = values.len() / 3;
        values[width..2 * width].fill(0.0);
    }
    values
}

/// The largest of relative differences, and where it is.
struct Largest(f64, String);

impl Largest {
    fn of(differences: impl Iterator<Item = (f64, String)>) -> Self {
        // A difference that is no number is larger than any.
        let largest = differences.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let (difference, place) = largest.expect("something to compare");
        Self(difference.abs(), place)
    }

    fn must_be_below(&self, tolerance: f64, what: &str) {
        let Self(difference, place) = self;
        println!("{what}: {difference:.1e} apart at most, {place}");
        assert!(
            *difference < tolerance,
            "{what}: {difference:.1e} apart, {place}; {tolerance:.0e} is allowed"
        );
    }
}

/// Holds what two trainings did against the tolerances.
fn compare(cpu: &Trained, gpu: &Trained) {
    assert_eq!(cpu.before, gpu.before, "both start from the same weights");
    let steps = cpu.losses.iter().zip(&gpu.losses).enumerate();
    Largest::of(steps.flat_map(|(step, (cpu, gpu))| {
        assert_eq!(cpu.len(), gpu.len());
        cpu.iter().zip(gpu).map(move |(cpu, gpu)| {
            assert_eq!(cpu.weight, gpu.weight, "the same masks");
            (
                gpu.mean / cpu.mean - 1.0,
                format!("{} at step {step}", cpu.name),
            )
        })
    }))
    .must_be_below(LOSS, "losses");
    let validation = gpu.validation / cpu.validation - 1.0;
    Largest::of([(validation, "after the last step".to_owned())].into_iter())
        .must_be_below(LOSS, "validation");
    Largest::of(cpu.gradients.iter().map(|(name, expected)| {
        let [expected, found] = [expected, &gpu.gradients[name]].map(|v| without_keys(name, v));
        (distance(&expected, &found) / norm(&expected), name.clone())
    }))
    .must_be_below(GRADIENT, "gradients of the first step");
    Largest::of(cpu.before.iter().map(|(name, before)| {
        let after = [&cpu.after[name], &gpu.after[name], before];
        let [expected, found, before] = after.map(|v| without_keys(name, v));
        let moved = distance(&before, &expected);
        (distance(&expected, &found) / moved, name.clone())
    }))
    .must_be_below(WEIGHT, "changes of the weights");
    let ratio = gpu.step.as_secs_f64() / cpu.step.as_secs_f64();
    println!(
        "a step: {:.1?} on flex, {:.1?} on wgpu, {ratio:.2} times",
        cpu.step, gpu.step
    );
}

/// The CPU's device and the GPU's; none, with the test booked as skipped, without an adapter.
fn devices() -> Option<[Device; 2]> {
    let cpu = Device::flex().autodiff();
    Some([cpu, gpu()?])
}

/// Trains from a model's weights on both devices, and compares.
fn train_on_both<'d, L: Learner>(
    [cpu, gpu]: [&'d Device; 2],
    model: L::Model,
    learner: impl Fn(&'d Device) -> L,
) {
    let on_cpu = train(&learner(cpu), model.clone());
    let on_gpu = train(&learner(gpu), model.fork(gpu));
    compare(&on_cpu, &on_gpu);
}

fn train_teacher(preset: &Preset) {
    let Some([cpu, gpu]) = devices() else {
        return;
    };
    let corpus = corpus();
    let (shape, settings) = (preset.teacher.window_shape(), &preset.teacher_training);
    let model = Teacher::new(SEED, &preset.teacher, 3, &cpu);
    train_on_both([&cpu, &gpu], model, |device| {
        TeacherLearner::new(shape, &corpus, &corpus, settings, SEED, device)
    });
}

#[test]
fn a_teacher_trains_as_on_the_cpu() {
    let mut preset = Preset::find("quickstart").unwrap();
    preset.teacher.attention_dropout = preset.teacher.dropout;
    let settings = &mut preset.teacher_training;
    settings.batch = 16;
    settings.tasks.push(Task::SelfSupervised);
    train_teacher(&preset);
}

#[test]
fn windows_of_the_papers_tokens_train_as_on_the_cpu() {
    let mut preset = Preset::find("paper").unwrap();
    let teacher = &mut preset.teacher;
    (teacher.d_model, teacher.feed_forward, teacher.layers) = (32, 32, 1);
    let settings = &mut preset.teacher_training;
    // The scores of six windows, a shard's, are more than 128 MiB, and more than what lavapipe binds.
    (settings.batch, settings.stride) = (12, 600);
    settings.tasks.push(Task::SelfSupervised);
    train_teacher(&preset);
}

#[test]
fn a_student_is_distilled_as_on_the_cpu() {
    let Some([cpu, gpu]) = devices() else {
        return;
    };
    let corpus = corpus();
    let mut preset = Preset::find("quickstart").unwrap();
    preset.distillation.batch = 8;
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let soft_targets: Vec<Vec<LookBackLogits>> = corpus
        .streams
        .iter()
        .map(|stream| {
            (0..stream.emg.len() / PATCH)
                .map(|_| rng.random())
                .collect()
        })
        .collect();
    let (span, settings) = (preset.student.span, &preset.distillation);
    let model = Student::new(SEED, &preset.student, 3, false, &cpu);
    train_on_both([&cpu, &gpu], model, |device| {
        let teaching = Teaching::Teacher(soft_targets.clone());
        StudentLearner::new(
            "student", span, &corpus, teaching, &corpus, settings, device,
        )
    });
}
