//! Streaming against a full recompute, and the integer encoder against its formulas in f64.

mod naive;

use alloc::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::intent::Vocabulary;
use crate::model::dimensions::{MAX_SPAN, receptive_field};
use crate::model::file::{LinearParts, ModelParts, NormParts, random::random_model};
use crate::model::noise::Noise;
use crate::units::{LOOK_BACK, WINDOW_PATCHES};

/// Width, layers and span.
type Shape = (usize, usize, usize);

fn random((width, layers, span): Shape, seed: u64) -> (ModelParts, Vec<u8>) {
    let vocabulary = if seed.is_multiple_of(2) {
        Vocabulary::Three
    } else {
        Vocabulary::Six
    };
    let parts = random_model(
        Dimensions {
            other: seed % 3 == 1,
            ..Dimensions::new(vocabulary, width, layers, span)
        },
        seed,
    );
    let bytes = parts.to_bytes().unwrap();
    (parts, bytes)
}

fn encoder(bytes: &[u8]) -> HostEncoder<'_> {
    HostEncoder::new(&Model::parse(bytes).unwrap()).unwrap()
}

/// Patches of random amplitude, from zeros to full scale.
fn noisy_patches(count: usize, seed: u64) -> Vec<Patch> {
    let mut noise = Noise(seed ^ 0xface);
    let mut patch = || {
        let amplitude = [0, 3, 20, 128][noise.bits() as usize % 4];
        let mut patch = Patch::default();
        patch
            .as_flattened_mut()
            .fill_with(|| (noise.bits() % (amplitude + 1)) as u8);
        patch
    };
    (0..count).map(|_| patch()).collect()
}

/// A fresh state after these patches, computed several at once, and the newest six outputs, newest
/// first.
fn recomputed<const WIDTH: usize, const SLOTS: usize>(
    encoder: &Encoder<'_, WIDTH, SLOTS>,
    patches: &[Patch],
) -> (EncoderState<WIDTH, SLOTS>, [LookBackLogits; LOOK_BACK]) {
    let mut state = encoder.fresh();
    let mut outputs = [LookBackLogits::default(); LOOK_BACK];
    encoder.steps(&mut state, patches, |logits| {
        outputs.rotate_right(1);
        outputs[0] = logits;
    });
    (state, outputs)
}

fn bits(outputs: &[LookBackLogits]) -> Vec<u32> {
    outputs
        .as_flattened()
        .as_flattened()
        .iter()
        .map(|logit| logit.to_bits())
        .collect()
}

/// Every kind of shape: the smallest, heads that are no multiple of four wide, one layer of the
/// longest span, the most slots, a shipped model's.
fn any_shape() -> impl Strategy<Value = Shape> {
    prop::sample::select(&[
        (16, 2, 27),
        (24, 3, 18),
        (16, 1, MAX_SPAN),
        (40, 2, 5),
        (24, 3, 19),
        (16, 1, 1),
        (64, 2, 27),
    ])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Runs a whole stream and, at its end, the newest window through a fresh state.
    #[test]
    fn streaming_equals_a_full_recompute(
        shape in any_shape(), seed: u64, count in WINDOW_PATCHES..160,
    ) {
        let (_, bytes) = random(shape, seed);
        let encoder = encoder(&bytes);
        let patches = noisy_patches(count, seed);
        let mut streaming = encoder.fresh();
        let outputs = patches.iter().map(|patch| encoder.step(&mut streaming, patch));
        let mut outputs: Vec<LookBackLogits> = outputs.collect();
        let (mut state, newest) = recomputed(&encoder, &patches[count - WINDOW_PATCHES..]);
        outputs.reverse();
        prop_assert_eq!(bits(&newest), bits(&outputs[..LOOK_BACK]));
        // The recomputed state also goes on as the streaming one does.
        for patch in noisy_patches(shape.2, !seed) {
            let streamed = encoder.step(&mut streaming, &patch);
            let recomputed = encoder.step(&mut state, &patch);
            prop_assert_eq!(bits(&[streamed]), bits(&[recomputed]));
        }
    }
}

/// The capacity of the state has no influence on the outputs, nor has what the state held before.
#[test]
fn a_device_gives_the_outputs_of_the_host() {
    let mut state = DeviceState::fresh();
    for (layers, span) in [(2, 27), (3, 18), (2, 27)] {
        for width in [64, 48, 24] {
            let (_, bytes) = random((width, layers, span), 7);
            let model = Model::parse(&bytes).unwrap();
            let device = DeviceEncoder::new(&model).unwrap();
            let host = encoder(&bytes);
            state.reset();
            let mut host_state = host.fresh();
            for patch in noisy_patches(70, 9) {
                let outputs = [
                    device.step(&mut state, &patch),
                    host.step(&mut host_state, &patch),
                ];
                assert_eq!(bits(&outputs[..1]), bits(&outputs[1..]));
            }
        }
    }
}

#[test]
fn a_model_beyond_the_capacity_is_refused() {
    for (shape, slots) in [((72, 2, 27), 54), ((64, 2, 28), 56)] {
        let (_, bytes) = random(shape, 3);
        let refused = DeviceEncoder::new(&Model::parse(&bytes).unwrap()).unwrap_err();
        let expected = ModelError::TooLarge {
            width: shape.0,
            most_width: 64,
            slots,
            most_slots: 54,
        };
        assert_eq!(refused, expected);
    }
    let (_, bytes) = random((128, 3, 19), 3);
    assert!(HostEncoder::new(&Model::parse(&bytes).unwrap()).is_ok());
}

#[test]
fn a_window_of_fewer_patches_than_the_receptive_field_does_not_suffice() {
    // 52 patches reach one short of what the newest output depends on: the equality above is not
    // one that any two runs would satisfy.
    let (_, bytes) = random((16, 2, 27), 7);
    let encoder = encoder(&bytes);
    let patches = noisy_patches(100, 9);
    let (_, whole) = recomputed(&encoder, &patches);
    let (_, enough) = recomputed(&encoder, &patches[100 - receptive_field(2, 27)..]);
    let (_, short) = recomputed(&encoder, &patches[101 - receptive_field(2, 27)..]);
    assert_eq!(bits(&whole[..1]), bits(&enough[..1]));
    assert_ne!(bits(&whole[..1]), bits(&short[..1]));
}

#[test]
fn the_state_of_a_device_has_its_stated_size() {
    let bytes = size_of::<DeviceState>();
    // Keys and values: 54 x 64 i16 and 54 x 4 scales each; then two indices.
    let cache = 2 * (54 * 64 * 2 + 54 * 4 * 4) + 2 * size_of::<usize>();
    // Five times 64 numbers, 80 inputs, twice 64 codes, 64 sums; of a head 32 codes, sums, weights and
    // scaled weights.
    let token = 5 * 64 * 4 + 80 * 2 + 2 * 64 * 2 + 64 * 4 + 32 * (2 + 4 + 4 + 4);
    assert_eq!(bytes, cache + token);
}

fn distance_from_formulas(shape: Shape, seed: u64) -> f64 {
    let (parts, bytes) = random(shape, seed);
    let encoder = encoder(&bytes);
    let row_outputs = parts.dimensions.row_outputs();
    let patches = noisy_patches(80, seed);
    let mut state = encoder.fresh();
    let mut worst = 0.0_f64;
    for (patch, expected) in patches.iter().zip(naive::outputs(&parts, &patches)) {
        let logits = encoder.step(&mut state, patch);
        for (row, expected) in logits.iter().zip(expected.chunks(row_outputs)) {
            for (logit, expected) in row.iter().zip(expected) {
                worst = worst.max((f64::from(*logit) - expected).abs());
            }
            assert!(row[row_outputs..].iter().all(|&unused| unused == 0.0));
        }
    }
    worst
}

#[test]
fn the_integer_encoder_is_close_to_its_formulas() {
    let mut worst = 0.0_f64;
    for seed in 0..8 {
        worst = worst.max(distance_from_formulas((16, 2, 27), seed));
        worst = worst.max(distance_from_formulas((24, 3, 18), seed));
    }
    worst = worst.max(distance_from_formulas((64, 2, 27), 1));
    // Logits are of order 1; a wrong term anywhere moves them by 0.1 and more.
    assert!(worst < 0.03, "{worst}");
}

/// The largest numbers that the reader accepts, in the largest model, give finite logits.
#[test]
fn the_largest_numbers_give_finite_logits() {
    for sign in [1.0, -1.0] {
        let (mut parts, _) = random((128, 3, 18), 11);
        let linear = |linear: &mut LinearParts| {
            linear.weights.fill(127);
            linear.scales.fill(100.0);
            linear.bias.fill(sign * 100.0);
        };
        let norm = |norm: &mut NormParts| {
            norm.gain.fill(100.0);
            norm.bias.fill(sign * 100.0);
        };
        linear(&mut parts.embed);
        linear(&mut parts.head);
        norm(&mut parts.final_norm);
        for layer in &mut parts.layers {
            norm(&mut layer.norm1);
            norm(&mut layer.norm2);
            layer.relative_bias.fill(sign * 100.0);
            for part in [
                &mut layer.qkv,
                &mut layer.out,
                &mut layer.ff1,
                &mut layer.ff2,
            ] {
                linear(part);
            }
        }
        parts.companding = Companding::Linear;
        let bytes = parts.to_bytes().unwrap();
        let encoder = HostEncoder::new(&Model::parse(&bytes).unwrap()).unwrap();
        let mut state = encoder.fresh();
        for level in [0, 128, 1, 128] {
            let mut patch = Patch::from([[level; 8]; 10]);
            patch[3][5] = 128 - level;
            let logits = encoder.step(&mut state, &patch);
            assert!(logits.iter().flatten().all(|logit| logit.is_finite()));
        }
    }
}
