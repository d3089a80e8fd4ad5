//! What training and replaying cost on this machine: `cargo bench -p myointent`.

use std::hint::black_box;
use std::time::Duration;

use burn::tensor::Device;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use myointent::corpus::{Corpus, Stream};
use myointent::fit::{Learner as _, optimizer};
use myointent::preset::{BUILT_IN, Preset};
use myointent::recording::synth::{self, SynthOptions};
use myointent::stage::{integer_rows, settings};
use myointent::student::any_encoder::{WithEncoder, with_encoder};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::intent::Vocabulary;
use shared::model_file::{Dimensions, Model, samples::random_model};
use shared::pipeline::{Encode, Pipeline};
use shared::preprocess::clean;
use shared::safe_state::Start;
use shared::units::{Millis, Sample};

fn recording() -> myointent::recording::Recording {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 60,
        ..SynthOptions::default()
    };
    synth::generate(&options).remove(0)
}

/// One optimizer step of every preset's teacher and student, at the preset's batch; the paper's
/// teacher at a batch of 8.
fn training(criterion: &mut Criterion) {
    let device = Device::default().autodiff();
    let recording = recording();
    let stream = Stream {
        emg: clean(recording.samples.iter().copied()).collect(),
        labels: recording.labels_in(Vocabulary::Three),
    };
    let corpus = Corpus {
        vocabulary: Vocabulary::Three,
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
        let learner = myointent::teacher::training::learner(
            preset.teacher.patch,
            &corpus,
            &corpus,
            &preset.teacher_training,
            42,
            &device,
        );
        let mut model = Some(preset.teacher.init(3, &device));
        let mut adam = optimizer(0.01);
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let item = learner.epoch(&mut rng).remove(0);
        group.bench_function(format!("{name} teacher, batch {}", item.len()), |bencher| {
            bencher.iter(|| {
                let before = model.take().expect("put back below");
                let (gradients, _) =
                    myointent::fit::gradients(&learner, &before, learner.shards(&item, &mut rng));
                model = Some(adam.step(1e-4, before, gradients));
            });
        });
        let learner = myointent::student::distillation::learner(
            preset.student.span,
            &corpus,
            None,
            &corpus,
            &preset.distillation,
            &device,
        );
        let mut model = Some(preset.student.init(3, &device));
        let mut adam = optimizer(0.01);
        let item = learner.epoch(&mut rng).remove(0);
        group.bench_function(format!("{name} student, batch {}", item.len()), |bencher| {
            bencher.iter(|| {
                let before = model.take().expect("put back below");
                let (gradients, _) =
                    myointent::fit::gradients(&learner, &before, learner.shards(&item, &mut rng));
                model = Some(adam.step(1e-4, before, gradients));
            });
        });
    }
    group.finish();
}

struct Stream60<'s>(&'s [Sample], shared::smoother::Settings);

impl<'m> WithEncoder<'m> for Stream60<'_> {
    type Output = usize;

    fn run<E: Encode<State: Send> + Send + 'm>(self, encoder: E) -> usize {
        let mut pipeline =
            Pipeline::new(encoder, self.1, Start::Boot).expect("a model's own settings");
        let mut lines = 0;
        for (index, &sample) in self.0.iter().enumerate() {
            lines += pipeline
                .sample(Millis(index as u32 * 5), sample)
                .into_iter()
                .count();
        }
        lines
    }
}

/// A minute through the device's pipeline, and through the encoder alone; elements are samples.
fn replay(criterion: &mut Criterion) {
    let dimensions = Dimensions {
        width: 64,
        layers: 2,
        span: 27,
        vocabulary: Vocabulary::Three,
    };
    let bytes = random_model(dimensions, 1)
        .to_bytes()
        .expect("a random model is a model");
    let model = Model::parse(&bytes).expect("just written");
    let recording = recording();
    let emg: Vec<_> = clean(recording.samples.iter().copied()).collect();
    let mut group = criterion.benchmark_group("one minute of EMG");
    group.throughput(Throughput::Elements(recording.samples.len() as u64));
    group.bench_function("replay: the whole pipeline", |bencher| {
        bencher.iter(|| {
            with_encoder(
                &model,
                Stream60(
                    black_box(&recording.samples),
                    settings(&model.header.smoother),
                ),
            )
            .expect("a compiled shape")
        });
    });
    group.bench_function("evaluate: the encoder alone", |bencher| {
        bencher.iter(|| integer_rows(&model, black_box(&emg)).expect("a compiled shape"));
    });
    group.finish();
}

criterion_group!(benches, replay, training);
criterion_main!(benches);
