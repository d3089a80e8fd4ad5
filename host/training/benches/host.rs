//! Speed of training and of replay on this machine: `cargo bench -p myointent`; with `--features ndarray`
//! on both CPU backends.

use std::hint::black_box;
use std::time::Duration;

use burn::tensor::Device;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use evaluation::inference::integer_logits;
use presets::distillation;
use presets::{BUILT_IN, Preset};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use recordings::corpus::{Corpus, Stream};
use recordings::synthetic::{self, SynthOptions};
use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::encoder::HostEncoder;
use shared::model::file::{Model, random::random_model};
use shared::pipeline::Pipeline;
use shared::stream::preprocess::{Median, clean};
use shared::stream::safe_state::Start;
use shared::units::{Millis, Sample};
use training::optimization::learner::Learner;
use training::optimization::optimizer::{gradients, optimizer};
use training::student::learner::{StudentLearner, Teaching};
use training::student::model::Student;
use training::teacher::learner::TeacherLearner;
use training::teacher::model::Teacher;

fn recording() -> recordings::Recording {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 60,
        ..SynthOptions::default()
    };
    synthetic::generate(&options).remove(0)
}

#[cfg_attr(
    feature = "ndarray",
    expect(deprecated, reason = "compared on purpose, see docs/decisions.md")
)]
/// All CPU backends that are compiled in.
fn devices() -> Vec<(&'static str, Device)> {
    vec![
        #[cfg(feature = "flex")]
        ("flex", Device::flex()),
        #[cfg(feature = "ndarray")]
        ("ndarray", Device::ndarray()),
    ]
}

/// One optimizer step of every preset's teacher and student, at the preset's batch; the paper's
/// teacher at a batch of 8.
fn training(criterion: &mut Criterion) {
    let recording = recording();
    let labels = recording.labels_in(Vocabulary::Three);
    let stream = Stream::new(recording.samples, labels);
    let corpus = Corpus {
        vocabulary: Vocabulary::Three,
        other: false,
        streams: vec![stream],
    };
    let mut group = criterion.benchmark_group("training step");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(8));
    for (name, _) in BUILT_IN {
        let mut preset = Preset::find(name).expect("a built-in preset");
        if name == "paper" {
            preset.teacher_training.batch = 8;
        }
        for (backend, device) in devices() {
            let device = device.autodiff();
            let learner = TeacherLearner::new(
                preset.teacher.window_shape(),
                &corpus,
                &corpus,
                &preset.teacher_training,
                42,
                &device,
            );
            let title = format!(
                "{name} teacher, batch {}, {backend}",
                preset.teacher_training.batch
            );
            steps(
                &mut group,
                &title,
                &learner,
                Teacher::new(&preset.teacher, 3, &device),
            );
            let learner = StudentLearner::new(
                distillation::NAME,
                preset.student.span,
                &corpus,
                Teaching::Labels,
                &corpus,
                &preset.distillation,
                &device,
            );
            let title = format!(
                "{name} student, batch {}, {backend}",
                preset.distillation.batch
            );
            steps(
                &mut group,
                &title,
                &learner,
                Student::new(&preset.student, 3, false, &device),
            );
        }
    }
    group.finish();
}

fn steps<L: Learner>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    title: &str,
    learner: &L,
    model: L::Model,
) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut model = Some(model);
    let mut adam = optimizer(0.01);
    let item = learner.epoch(&mut rng).remove(0);
    group.bench_function(title, |bencher| {
        bencher.iter(|| {
            let before = model.take().expect("put back below");
            let (gradients, _) = gradients(learner, &before, learner.shards(&item, &mut rng));
            model = Some(adam.step(1e-4, before, gradients));
        });
    });
}

/// Counts the UART lines of a stream.
fn lines(model: &Model<'_>, samples: &[Sample]) -> usize {
    let encoder = HostEncoder::new(model).expect("a valid model");
    let mut state = encoder.fresh();
    let settings = model.header.smoother.in_patches();
    let mut pipeline =
        Pipeline::new(encoder, &mut state, settings, Start::Boot).expect("a model's own settings");
    let mut lines = 0;
    for (index, &sample) in samples.iter().enumerate() {
        lines += pipeline
            .sample(Millis(index as u32 * 5), sample)
            .into_iter()
            .count();
    }
    lines
}

/// Measures the device's pipeline, and the encoder alone, on a minute of samples; elements are samples.
fn replay(criterion: &mut Criterion) {
    let dimensions = Dimensions {
        width: 64,
        layers: 2,
        span: 27,
        vocabulary: Vocabulary::Three,
        other: false,
    };
    let bytes = random_model(dimensions, 1)
        .to_bytes()
        .expect("a random model is a model");
    let model = Model::parse(&bytes).expect("just written");
    let recording = recording();
    let emg: Vec<_> = clean(recording.samples.iter().copied(), Median::Three).collect();
    let mut group = criterion.benchmark_group("one minute of EMG");
    group.throughput(Throughput::Elements(recording.samples.len() as u64));
    group.bench_function("replay: the whole pipeline", |bencher| {
        bencher.iter(|| lines(&model, black_box(&recording.samples)));
    });
    group.bench_function("evaluate: the encoder alone", |bencher| {
        bencher.iter(|| integer_logits(&model, black_box(&emg)).expect("a compiled shape"));
    });
    group.finish();
}

criterion_group!(benches, replay, training);
criterion_main!(benches);
