//! What one patch costs on this machine: `cargo bench -p myointent-shared --features write`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use shared::{
    encoder::{Encoder, Patch},
    intent::Vocabulary,
    model_file::{
        Dimensions, Model,
        samples::{Noise, random_model},
    },
};

fn encoder<const D: usize, const L: usize, const SPAN: usize>(bench: &mut Criterion) {
    let vocabulary = Vocabulary::Three;
    let parts = random_model(
        Dimensions {
            width: D,
            layers: L,
            span: SPAN,
            vocabulary,
        },
        1,
    );
    let bytes = parts.to_bytes().expect("a random model is a model");
    let model = Model::parse(&bytes).expect("just written");
    let encoder = Encoder::<D, L, SPAN>::new(&model).expect("of this shape");
    let mut noise = Noise(2);
    let mut patch = Patch::default();
    patch
        .as_flattened_mut()
        .fill_with(|| (noise.bits() % 129) as u8);
    let patches = vec![patch; 60];
    let (mut state, _) = encoder.from_scratch(&patches);
    let name = format!(
        "encoder step d {D} L {L} span {SPAN}, file {} bytes",
        bytes.len()
    );
    bench.bench_function(&name, |bencher| {
        bencher.iter(|| encoder.step(black_box(&mut state), black_box(&patch)));
    });
}

criterion_group!(line, encoder::<64, 2, 27>, encoder::<96, 3, 18>);
criterion_main!(line);
