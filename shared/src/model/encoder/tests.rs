//! Streaming against from scratch, and the integer encoder against its formulas in f64.

use alloc::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::intent::Vocabulary;
use crate::model::file::{
    Dimensions, ModelParts,
    samples::{Noise, random_model},
};

fn model_bytes(width: usize, layers: usize, span: usize, seed: u64) -> (ModelParts, Vec<u8>) {
    let vocabulary = if seed.is_multiple_of(2) {
        Vocabulary::Three
    } else {
        Vocabulary::Six
    };
    let parts = random_model(
        Dimensions {
            width,
            layers,
            span,
            vocabulary,
        },
        seed,
    );
    let bytes = parts.to_bytes().unwrap();
    (parts, bytes)
}

/// Loud and quiet stretches, zeros and full scale among them.
fn noisy_patches(count: usize, seed: u64) -> Vec<Patch> {
    let mut noise = Noise(seed ^ 0xface);
    let mut patch = || {
        let loudest = [0, 3, 20, 128][noise.bits() as usize % 4];
        let mut patch = Patch::default();
        patch
            .as_flattened_mut()
            .fill_with(|| (noise.bits() % (loudest + 1)) as u8);
        patch
    };
    (0..count).map(|_| patch()).collect()
}

/// A fresh state that several patches at once have gone through, and the newest six outputs, newest first.
fn from_scratch<const D: usize, const L: usize, const SPAN: usize>(
    encoder: &Encoder<'_, D, L, SPAN>,
    patches: &[Patch],
) -> (EncoderState<D, L, SPAN>, [Logits; LOOK_BACK]) {
    let mut state = encoder.fresh();
    let mut outputs = [Logits::default(); LOOK_BACK];
    encoder.steps(&mut state, patches, |logits| {
        outputs.rotate_right(1);
        outputs[0] = logits;
    });
    (state, outputs)
}

/// Runs a whole stream and, at its end, the newest window through a fresh state.
fn compare<const D: usize, const L: usize, const SPAN: usize>(seed: u64, count: usize) {
    let (_, bytes) = model_bytes(D, L, SPAN, seed);
    let encoder = Encoder::<D, L, SPAN>::new(&Model::parse(&bytes).unwrap()).unwrap();
    let patches = noisy_patches(count, seed);
    let mut streaming = encoder.fresh();
    let mut outputs: Vec<Logits> = patches
        .iter()
        .map(|patch| encoder.step(&mut streaming, patch))
        .collect();
    let (mut rebuilt, newest) = from_scratch(&encoder, &patches[count - WINDOW_PATCHES..]);
    outputs.reverse();
    assert_eq!(bits(&newest), bits(&outputs[..LOOK_BACK]));
    // The rebuilt state also goes on as the uninterrupted one does.
    for patch in noisy_patches(SPAN, seed + 1) {
        let [uninterrupted, rebuilt] = [
            encoder.step(&mut streaming, &patch),
            encoder.step(&mut rebuilt, &patch),
        ];
        assert_eq!(bits(&[uninterrupted]), bits(&[rebuilt]));
    }
}

fn bits(outputs: &[Logits]) -> Vec<u32> {
    outputs
        .as_flattened()
        .as_flattened()
        .iter()
        .map(|logit| logit.to_bits())
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn streaming_equals_from_scratch_small(seed: u64, count in WINDOW_PATCHES..200) {
        compare::<16, 2, 27>(seed >> 1, count);
    }

    #[test]
    fn streaming_equals_from_scratch_three_layers(seed: u64, count in WINDOW_PATCHES..120) {
        compare::<24, 3, 18>(seed >> 1, count);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn streaming_equals_from_scratch_full_size(seed: u64, count in WINDOW_PATCHES..120) {
        compare::<64, 2, 27>(seed >> 1, count);
    }
}

#[test]
fn a_window_of_fewer_patches_than_the_receptive_field_does_not_suffice() {
    // 52 patches reach one short of what the newest output depends on: the equality above is not
    // one that any two runs would satisfy.
    let (_, bytes) = model_bytes(16, 2, 27, 7);
    let encoder = Encoder::<16, 2, 27>::new(&Model::parse(&bytes).unwrap()).unwrap();
    let patches = noisy_patches(100, 9);
    let (_, whole) = from_scratch(&encoder, &patches);
    let (_, enough) = from_scratch(&encoder, &patches[100 - receptive_field(2, 27)..]);
    let (_, short) = from_scratch(&encoder, &patches[101 - receptive_field(2, 27)..]);
    assert_eq!(bits(&whole[..1]), bits(&enough[..1]));
    assert_ne!(bits(&whole[..1]), bits(&short[..1]));
}

#[test]
fn a_reset_state_is_a_fresh_one() {
    let (_, bytes) = model_bytes(16, 2, 27, 3);
    let encoder = Encoder::<16, 2, 27>::new(&Model::parse(&bytes).unwrap()).unwrap();
    let (mut state, _) = from_scratch(&encoder, &noisy_patches(70, 1));
    state.reset();
    let mut fresh = encoder.fresh();
    for patch in noisy_patches(30, 2) {
        let [reset, fresh] = [
            encoder.step(&mut state, &patch),
            encoder.step(&mut fresh, &patch),
        ];
        assert_eq!(bits(&[reset]), bits(&[fresh]));
    }
}

#[test]
fn a_model_of_another_shape_is_refused() {
    let (_, bytes) = model_bytes(16, 2, 27, 3);
    let model = Model::parse(&bytes).unwrap();
    let refused = Encoder::<16, 3, 18>::new(&model).unwrap_err();
    let expected = ModelError::Shape {
        expected: (16, 3, 18),
        width: 16,
        layers: 2,
        span: 27,
    };
    assert_eq!(refused, expected);
    assert!(Encoder::<16, 2, 27>::new(&model).is_ok());
}

#[test]
fn the_state_of_the_usual_student_has_its_stated_size() {
    let bytes = size_of::<EncoderState<64, 2, 27>>();
    // Per layer keys and values of 27 x 64 i16 and 2 x 27 x 4 scales; then two indices.
    let memory = 2 * (2 * 27 * 64 * 2 + 2 * 27 * 4 * 4) + 2 * size_of::<usize>();
    // Five times 64 numbers, 80 inputs, codes of twice 64 and as many sums as once; of a head 32 codes, sums, weights and
    // folded ones.
    let token = 5 * 64 * 4 + 80 * 2 + 2 * 64 * 2 + 64 * 4 + 32 * (2 + 4 + 4 + 4);
    assert_eq!(bytes, memory + token);
}

/// The formulas of the module's first lines in f64, over all patches at once, with no
/// quantization but that of the weights.
mod naive {
    use super::*;
    use crate::model::file::{LayerParts, LinearParts, NormParts};

    type Vector = Vec<f64>;

    fn linear(map: &LinearParts, x: &[f64]) -> Vector {
        let row = |row: usize| {
            let weights = &map.weights[row * x.len()..(row + 1) * x.len()];
            let sum: f64 = weights.iter().zip(x).map(|(&w, x)| f64::from(w) * x).sum();
            sum * f64::from(map.scales[row]) + f64::from(map.bias[row])
        };
        (0..map.bias.len()).map(row).collect()
    }

    fn norm(norm: &NormParts, h: &[f64]) -> Vector {
        let mean = h.iter().sum::<f64>() / h.len() as f64;
        let variance = h.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / h.len() as f64;
        let normalised = h.iter().map(|x| (x - mean) / libm::sqrt(variance + 1e-5));
        let constants = norm.gain.iter().zip(&norm.bias);
        normalised
            .zip(constants)
            .map(|(x, (&g, &b))| x * f64::from(g) + f64::from(b))
            .collect()
    }

    fn attend(layer: &LayerParts, tokens: &[Vector], span: usize) -> Vec<Vector> {
        let width = tokens[0].len();
        let size = width / HEADS;
        let qkv: Vec<Vector> = tokens
            .iter()
            .map(|token| linear(&layer.qkv, token))
            .collect();
        let attend_one = |p: usize| {
            let mut attended = Vector::new();
            for head in 0..HEADS {
                let part = |t: usize, which: usize| {
                    let start = which * width + head * size;
                    &qkv[t][start..start + size]
                };
                let seen = (p + 1).saturating_sub(span)..p + 1;
                let weights: Vec<f64> = seen
                    .clone()
                    .map(|t| {
                        let product: f64 =
                            part(p, 0).iter().zip(part(t, 1)).map(|(q, k)| q * k).sum();
                        let bias = f64::from(layer.relative_bias[head * span + p - t]);
                        libm::exp(product / libm::sqrt(size as f64) + bias)
                    })
                    .collect();
                let sum: f64 = weights.iter().sum();
                attended.extend((0..size).map(|channel| {
                    let values = seen.clone().map(|t| part(t, 2)[channel]);
                    values
                        .zip(&weights)
                        .map(|(value, weight)| value * weight / sum)
                        .sum::<f64>()
                }));
            }
            linear(&layer.out, &attended)
        };
        (0..tokens.len()).map(attend_one).collect()
    }

    pub fn outputs(model: &ModelParts, patches: &[Patch]) -> Vec<Vector> {
        let value = |x: &u8| libm::sqrt(f64::from(*x) / 128.0);
        let embed = |patch: &Patch| {
            linear(
                &model.embed,
                &patch.as_flattened().iter().map(value).collect::<Vector>(),
            )
        };
        let mut h: Vec<Vector> = patches.iter().map(embed).collect();
        for layer in &model.layers {
            let tokens: Vec<Vector> = h.iter().map(|h| norm(&layer.norm1, h)).collect();
            let updates = attend(layer, &tokens, model.dimensions.span);
            for (h, update) in h.iter_mut().zip(&updates) {
                h.iter_mut().zip(update).for_each(|(h, x)| *h += x);
                let hidden = linear(&layer.ff1, &norm(&layer.norm2, h));
                let hidden: Vector = hidden
                    .iter()
                    .map(|x| x / (1.0 + libm::exp(-1.702 * x)))
                    .collect();
                let update = linear(&layer.ff2, &hidden);
                h.iter_mut().zip(&update).for_each(|(h, x)| *h += x);
            }
        }
        h.iter()
            .map(|h| linear(&model.head, &norm(&model.final_norm, h)))
            .collect()
    }
}

fn distance_from_formulas<const D: usize, const L: usize, const SPAN: usize>(seed: u64) -> f64 {
    let (parts, bytes) = model_bytes(D, L, SPAN, seed);
    let encoder = Encoder::<D, L, SPAN>::new(&Model::parse(&bytes).unwrap()).unwrap();
    let classes = encoder.classes();
    let patches = noisy_patches(80, seed);
    let mut state = encoder.fresh();
    let mut worst = 0.0_f64;
    for (patch, truth) in patches.iter().zip(naive::outputs(&parts, &patches)) {
        let logits = encoder.step(&mut state, patch);
        for (row, truth) in logits.iter().zip(truth.chunks(classes)) {
            for (logit, truth) in row.iter().zip(truth) {
                worst = worst.max((f64::from(*logit) - truth).abs());
            }
            assert!(row[classes..].iter().all(|&unused| unused == 0.0));
        }
    }
    worst
}

#[test]
fn the_integer_encoder_stays_by_its_formulas() {
    let mut worst = 0.0_f64;
    for seed in 0..8 {
        worst = worst.max(distance_from_formulas::<16, 2, 27>(seed));
        worst = worst.max(distance_from_formulas::<24, 3, 18>(seed));
    }
    worst = worst.max(distance_from_formulas::<64, 2, 27>(1));
    // Logits are of order 1; a wrong term anywhere moves them by 0.1 and more.
    assert!(worst < 5e-3, "{worst}");
}
