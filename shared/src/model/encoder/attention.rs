//! Causal attention over the newest patches, with its memory.

use super::{
    HEADS, MAX_SPAN,
    linear::{self, Added, Mapped, as_is, quantize},
    norm::normalise,
    token::Token,
};
use crate::model::arithmetic::{exp, inverse_square_root};
use crate::model::file::LayerWeights;
use crate::model::kernels::{Active, Aligned, KEY_LIMIT, Kernels, QUERY_LIMIT};

/// Keys and values of the newest `SPAN` patches of one layer, quantized per patch and head.
///
/// A ring: slot `s` holds some patch until the patch `SPAN` later takes its place.
#[derive(Clone, Debug)]
pub struct Memory<const D: usize, const SPAN: usize> {
    keys: Aligned<[[i16; D]; SPAN]>,
    key_scales: [[f32; SPAN]; HEADS],
    values: Aligned<[[i16; D]; SPAN]>,
    value_scales: [[f32; SPAN]; HEADS],
}

impl<const D: usize, const SPAN: usize> Memory<D, SPAN> {
    /// All zeros.
    pub const EMPTY: Self = Self {
        keys: Aligned([[0; D]; SPAN]),
        key_scales: [[0.0; SPAN]; HEADS],
        values: Aligned([[0; D]; SPAN]),
        value_scales: [[0.0; SPAN]; HEADS],
    };

    /// `h += W_o a + b_o`, a being what each patch attends to: itself and what is remembered.
    ///
    /// Keeps the patches' keys and values in their places, the oldest first: the newest of a full ring takes the place of
    /// one that those before it still see.
    #[inline]
    pub fn attend<const T: usize>(
        &mut self,
        layer: &LayerWeights<'_>,
        places: [Place; T],
        tokens: &mut [Token<D>; T],
    ) {
        let inside = tokens.each_mut().map(|token| {
            normalise(&layer.norm1, &token.h, &mut token.normalised);
            Mapped {
                token: quantize(&token.normalised, &mut token.codes),
                outputs: token.wide.as_flattened_mut(),
            }
        });
        linear::map(&layer.qkv, inside, as_is);
        for (token, place) in tokens.iter_mut().zip(places) {
            self.attend_heads(layer, place, token);
        }
        let outside = tokens.each_mut().map(|token| Added {
            token: quantize(&token.normalised, &mut token.codes),
            sums: &mut token.sums,
            h: &mut token.h,
        });
        linear::add(&layer.out, outside);
    }

    /// What the heads attend to comes to where the normalised token was.
    #[inline]
    fn attend_heads(&mut self, layer: &LayerWeights<'_>, place: Place, token: &mut Token<D>) {
        let [query, key, value] = &token.wide;
        let slot = place.slot;
        remember(key, &mut self.keys.0[slot], &mut self.key_scales, slot);
        remember(
            value,
            &mut self.values.0[slot],
            &mut self.value_scales,
            slot,
        );
        let width = const { D / HEADS };
        let heads = query
            .chunks_exact(width)
            .zip(token.normalised.chunks_exact_mut(width));
        for (head, (query, attended)) in heads.enumerate() {
            let bias = &layer.relative_bias[head * SPAN..(head + 1) * SPAN];
            self.attend_head(head, query, bias, place, &mut token.heads, attended);
        }
    }

    /// `attended = sum over t of softmax(q k_t / sqrt(width) + bias[p - t]) v_t` of one head.
    ///
    /// Sums over patches run from the newest back, wherever the ring begins: a rebuilt state has
    /// its patches in other slots and must give the same bits.
    #[inline]
    fn attend_head(
        &self,
        head: usize,
        query: &[f32],
        bias: &[f32],
        Place {
            slot: newest,
            filled,
        }: Place,
        heads: &mut Heads,
        attended: &mut [f32],
    ) {
        let width = const { D / HEADS };
        let first = head * width;
        let Heads {
            codes,
            sums,
            weights,
            folded,
        } = heads;
        let query_codes = &mut codes.0[..width];
        let scale =
            Active::quantize(query, QUERY_LIMIT, query_codes) * inverse_square_root(width as f32);
        let keys = &self.keys.0.as_flattened()[first..];
        Active::row_products(query_codes, keys, D, &mut sums[..filled]);

        // Slots up to the newest patch's, then those that the ring has not come round to again; in each the
        // later slot is the later patch, and a bias belongs to an age.
        let parts = [0..newest + 1, newest + 1..filled];
        let mut largest = f32::MIN;
        for slots in parts.clone() {
            let scores = weights[slots.clone()].iter_mut();
            let scales = &self.key_scales[head][slots.clone()];
            let products = sums[slots.clone()].iter().zip(scales);
            let biases = bias[slots].iter().rev();
            for ((score, (&product, key_scale)), bias) in scores.zip(products).zip(biases) {
                *score = product as f32 * (scale * key_scale) + bias;
                if *score > largest {
                    largest = *score;
                }
            }
        }

        // The weights stay unnormalised and take up the scale of their value; what is divided by
        // their sum is the one factor of the result.
        let scales = &self.value_scales[head][..filled];
        for ((weight, folded), scale) in weights.iter_mut().zip(&mut *folded).zip(scales) {
            *weight = exp(*weight - largest);
            *folded = *weight * scale;
        }
        let mut sum = 0.0;
        for slots in parts {
            for weight in weights[slots].iter().rev() {
                sum += weight;
            }
        }
        let slots = const { SPAN.next_multiple_of(4) };
        folded[filled..slots].fill(0.0);
        let codes = &mut codes.0[..slots];
        let scale = Active::quantize(&folded[..slots], QUERY_LIMIT, codes) / sum;

        let values = &self.values.0.as_flattened()[first..];
        Active::weighted_rows(&codes[..filled], values, D, &mut sums[..width]);
        for (attended, &sum) in attended.iter_mut().zip(&*sums) {
            *attended = sum as f32 * scale;
        }
    }
}

/// Where a patch comes to in the rings of all layers.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Place {
    /// Its slot.
    pub slot: usize,
    /// Slots that count, its own included.
    pub filled: usize,
}

/// Quantizes a key or a value, head by head, into its slot.
#[inline]
fn remember<const D: usize, const SPAN: usize>(
    token: &[f32; D],
    codes: &mut [i16; D],
    scales: &mut [[f32; SPAN]; HEADS],
    slot: usize,
) {
    let width = const { D / HEADS };
    let heads = token.chunks_exact(width).zip(codes.chunks_exact_mut(width));
    for ((token, codes), scales) in heads.zip(scales) {
        scales[slot] = Active::quantize(token, KEY_LIMIT, codes);
    }
}

/// Where one head after another is worked out.
#[derive(Clone, Debug)]
pub struct Heads {
    /// The query's, then the attention weights'.
    codes: Aligned<[i16; MAX_SPAN]>,
    /// By slot, then by channel of the head.
    sums: [i32; MAX_SPAN],
    /// By slot: scores, then weights.
    weights: [f32; MAX_SPAN],
    /// Weights times the scales of their values.
    folded: [f32; MAX_SPAN],
}

impl Heads {
    /// All zeros.
    pub const EMPTY: Self = Self {
        codes: Aligned([0; MAX_SPAN]),
        sums: [0; MAX_SPAN],
        weights: [0.0; MAX_SPAN],
        folded: [0.0; MAX_SPAN],
    };
}
