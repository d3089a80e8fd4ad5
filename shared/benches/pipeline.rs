//! Cost of one patch on this machine: `cargo bench -p myointent-shared --features write`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use shared::intent::{MAX_LOGITS, Vocabulary};
use shared::model::Encode as _;
use shared::model::dimensions::{Dimensions, usual_span};
use shared::model::encoder::{DeviceEncoder, Encoder, HostEncoder};
use shared::model::file::{Model, random::random_model};
use shared::model::noise::Noise;
use shared::stream::preprocess::{Median, Preprocessor};
use shared::stream::smoother::{Settings, Smoother};
use shared::units::{LOOK_BACK, PATCH, Patch, Sample, SampleIndex};

fn encoders(bench: &mut Criterion) {
    for (width, layers) in [(64, 2), (96, 3)] {
        let dimensions = Dimensions {
            width,
            layers,
            span: usual_span(layers),
            vocabulary: Vocabulary::Three,
            other: false,
        };
        let parts = random_model(dimensions, 1);
        let bytes = parts.to_bytes().expect("a random model is a model");
        let model = Model::parse(&bytes).expect("just written");
        let name = format!("d {width} L {layers}, file {} bytes", bytes.len());
        let encoder = HostEncoder::new(&model).expect("room for every model");
        steps(bench, &name, &encoder);
        if let Ok(encoder) = DeviceEncoder::new(&model) {
            steps(bench, &format!("{name}, device"), &encoder);
        }
    }
}

fn steps<const WIDTH: usize, const SLOTS: usize>(
    bench: &mut Criterion,
    name: &str,
    encoder: &Encoder<'_, WIDTH, SLOTS>,
) {
    let mut noise = Noise(2);
    let mut patch = Patch::default();
    patch
        .as_flattened_mut()
        .fill_with(|| (noise.bits() % 129) as u8);
    let patches = vec![patch; 60];
    let mut state = encoder.fresh();
    encoder.steps(&mut state, &patches, |logits| {
        black_box(logits);
    });
    bench.bench_function(&format!("encoder step {name}"), |bencher| {
        bencher.iter(|| encoder.step(black_box(&mut state), black_box(&patch)));
    });
    bench.bench_function(&format!("60 steps {name}"), |bencher| {
        bencher.iter(|| {
            encoder.steps(black_box(&mut state), black_box(&patches), |logits| {
                black_box(logits);
            });
        });
    });
}

/// Median and rectification of one patch's ten samples.
fn preprocessing(bench: &mut Criterion) {
    let mut noise = Noise(3);
    let samples: Vec<Sample> = (0..PATCH)
        .map(|_| core::array::from_fn(|_| noise.bits() as i8))
        .collect();
    let mut preprocessor = Preprocessor::new(Median::Three);
    bench.bench_function("preprocess ten samples", |bencher| {
        bencher.iter(|| {
            for &sample in black_box(&samples) {
                black_box(preprocessor.push(sample));
            }
        });
    });
}

/// Smooths one patch's rows with the paper's look-ahead.
fn smoother(bench: &mut Criterion) {
    let mut noise = Noise(4);
    let mut rows = [[0.0; MAX_LOGITS]; LOOK_BACK];
    rows.as_flattened_mut().fill_with(|| noise.signed());
    let mut smoother = Smoother::<MAX_LOGITS, LOOK_BACK>::new(Settings::PAPER_IN_PATCHES, 3)
        .expect("the defaults");
    let mut end = 0;
    bench.bench_function("smooth one patch", |bencher| {
        bencher.iter(|| {
            end += PATCH as u32;
            smoother.push(SampleIndex(end), black_box(&rows))
        });
    });
}

criterion_group!(parts, preprocessing, encoders, smoother);
criterion_main!(parts);
