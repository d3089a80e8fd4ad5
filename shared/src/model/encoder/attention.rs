//! Causal attention over the newest patches.

use super::{
    cache::{LayerCache, Slot},
    linear::{self, Added, Mapped, quantize},
    token::{HeadScratch, Token, layer_norm},
};
use crate::arithmetic::exp;
use crate::kernels::{Active, KEY_LIMIT, Kernels, QUERY_LIMIT};
use crate::model::dimensions::{Dimensions, HEADS};
use crate::model::file::LayerWeights;

/// The attention half of one layer.
#[derive(Debug)]
pub(super) struct Attention<'a> {
    pub weights: &'a LayerWeights<'a>,
    pub cache: LayerCache<'a>,
    pub dimensions: &'a Dimensions,
    /// Factor of every score: the reciprocal square root of a head's width.
    pub score_scale: f32,
}

impl Attention<'_> {
    /// `h += W_o a + b_o`, a being the attention output of each patch: over itself and the patches
    /// in the cache.
    ///
    /// The patches' keys and values go into their slots, the oldest patch first: in a full ring the
    /// newest patch's slot holds a patch that those before it still attend to.
    // Calls instead of inlined copies, here and in `head`: measured 1.6 % fewer instructions a step.
    #[inline(never)]
    pub fn apply<const T: usize, const WIDTH: usize>(
        &mut self,
        slots: [Slot; T],
        tokens: &mut [Token<WIDTH>; T],
    ) {
        let width = self.dimensions.width;
        let inside = tokens.each_mut().map(|token| {
            let normalised = &mut token.normalised[..width];
            layer_norm(&self.weights.norm1, &token.residual[..width], normalised);
            Mapped {
                token: quantize(&self.weights.qkv, normalised, &mut token.codes),
                outputs: &mut token.wide.as_flattened_mut()[..3 * width],
            }
        });
        linear::map(&self.weights.qkv, inside);
        for (token, slot) in tokens.iter_mut().zip(slots) {
            self.heads(slot, token);
        }
        let outside = tokens.each_mut().map(|token| Added {
            token: quantize(
                &self.weights.out,
                &token.normalised[..width],
                &mut token.codes,
            ),
            sums: &mut token.sums[..width],
            residual: &mut token.residual[..width],
        });
        linear::add(&self.weights.out, outside);
    }

    /// Stores key and value, then replaces the normalised token by the output of all heads.
    #[inline]
    fn heads<const WIDTH: usize>(&mut self, slot: Slot, token: &mut Token<WIDTH>) {
        let Dimensions { width, span, .. } = *self.dimensions;
        let (query, rest) = token.wide.as_flattened().split_at(width);
        let (key, rest) = rest.split_at(width);
        let value = &rest[..width];
        let cache = &mut self.cache;
        let codes = slot.index * width..(slot.index + 1) * width;
        store(
            key,
            &mut cache.keys[codes.clone()],
            &mut cache.key_scales,
            slot,
        );
        store(
            value,
            &mut cache.values[codes],
            &mut cache.value_scales,
            slot,
        );
        let head_width = width / HEADS;
        let heads = query
            .chunks_exact(head_width)
            .zip(token.normalised[..width].chunks_exact_mut(head_width));
        for (head, (query, attended)) in heads.enumerate() {
            let bias = &self.weights.relative_bias[head * span..(head + 1) * span];
            self.head(head, query, bias, slot, &mut token.head, attended);
        }
    }

    /// `attended = sum over t of softmax(q k_t / sqrt(width) + bias[p - t]) v_t` of one head.
    ///
    /// Sums over patches run from the newest to the oldest, in any order of slots: where the encoder takes a window anew,
    /// the same patches have other slots and must give the same bits.
    #[inline(never)]
    fn head(
        &self,
        head: usize,
        query: &[f32],
        bias: &[f32],
        Slot {
            index: newest,
            filled,
        }: Slot,
        scratch: &mut HeadScratch,
        attended: &mut [f32],
    ) {
        let width = self.dimensions.width;
        let first = head * query.len();
        let HeadScratch {
            codes,
            sums,
            weights,
            scaled,
        } = scratch;
        let query_codes = &mut codes.0[..query.len()];
        let scale = Active::quantize(query, QUERY_LIMIT, query_codes) * self.score_scale;
        let keys = &self.cache.keys[first..];
        Active::row_products(query_codes, keys, width, &mut sums[..filled]);

        // Two runs of slots: up to the newest patch's, then those of the ring's previous round. Within
        // a run a later slot holds a later patch; a bias belongs to an age.
        let runs = [0..newest + 1, newest + 1..filled];
        let mut largest = f32::MIN;
        for slots in runs.clone() {
            let scores = weights[slots.clone()].iter_mut();
            let scales = &self.cache.key_scales[head][slots.clone()];
            let products = sums[slots.clone()].iter().zip(scales);
            let biases = bias[slots].iter().rev();
            for ((score, (&product, key_scale)), bias) in scores.zip(products).zip(biases) {
                *score = product as f32 * (scale * key_scale) + bias;
                if *score > largest {
                    largest = *score;
                }
            }
        }

        // The weights stay unnormalised and are multiplied by the scale of their value; the division
        // by their sum is part of the result's one factor.
        let scales = &self.cache.value_scales[head][..filled];
        for ((weight, scaled), scale) in weights.iter_mut().zip(&mut *scaled).zip(scales) {
            *weight = exp(*weight - largest);
            *scaled = *weight * scale;
        }
        let mut sum = 0.0;
        for slots in runs {
            for weight in weights[slots].iter().rev() {
                sum += weight;
            }
        }
        // The kernels are fast with multiples of four.
        let padded = filled.next_multiple_of(4);
        scaled[filled..padded].fill(0.0);
        let codes = &mut codes.0[..padded];
        let scale = Active::quantize(&scaled[..padded], QUERY_LIMIT, codes) / sum;

        let values = &self.cache.values[first..];
        Active::weighted_rows(&codes[..filled], values, width, &mut sums[..query.len()]);
        for (attended, &sum) in attended.iter_mut().zip(&*sums) {
            *attended = sum as f32 * scale;
        }
    }
}

/// Quantizes a key or a value, head by head, into its slot.
#[inline]
fn store(token: &[f32], codes: &mut [i16], scales: &mut [&mut [f32]; HEADS], slot: Slot) {
    let width = token.len() / HEADS;
    let heads = token.chunks_exact(width).zip(codes.chunks_exact_mut(width));
    for ((token, codes), scales) in heads.zip(scales) {
        scales[slot.index] = Active::quantize(token, KEY_LIMIT, codes);
    }
}
