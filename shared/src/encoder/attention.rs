//! Causal attention over the newest patches, with its memory.

use super::{
    HEADS,
    linear::{add, linear_of_token, replace},
    norm::normalise,
};
use crate::{
    arithmetic::{exp, inverse_square_root},
    kernels::{Active, KEY_LIMIT, Kernels, QUERY_LIMIT},
    model_file::{Floats, LayerWeights},
};

/// Keys and values of the newest `SPAN` patches of one layer, quantized per patch and head.
///
/// A ring: slot `s` holds some patch until the patch `SPAN` later takes its place.
#[derive(Clone, Debug)]
pub struct Memory<const D: usize, const SPAN: usize> {
    keys: [[i16; D]; SPAN],
    key_scales: [[f32; HEADS]; SPAN],
    /// By channel, then slot: the weighted sum over the patches is then a product of two rows,
    /// the same loop as query times key.
    values: [[i16; SPAN]; D],
    value_scales: [[f32; HEADS]; SPAN],
}

impl<const D: usize, const SPAN: usize> Memory<D, SPAN> {
    /// All zeros.
    pub const EMPTY: Self = Self {
        keys: [[0; D]; SPAN],
        key_scales: [[0.0; HEADS]; SPAN],
        values: [[0; SPAN]; D],
        value_scales: [[0.0; HEADS]; SPAN],
    };

    /// `h += W_o a + b_o`, a being what the newest patch attends to.
    ///
    /// Keeps the patch's key and value in slot `newest`; `filled` slots, that one included, count.
    #[inline]
    pub fn attend(
        &mut self,
        layer: &LayerWeights<'_>,
        newest: usize,
        filled: usize,
        h: &mut [f32; D],
    ) {
        let token = normalise(&layer.norm1, h);
        let mut qkv = [[0.0; D]; 3];
        linear_of_token(&layer.qkv, &[token], qkv.as_flattened_mut(), replace);
        let [query, key, value] = qkv;
        self.remember(newest, &key, &value);
        let mut attended = [0.0; D];
        let width = const { D / HEADS };
        let heads = query
            .chunks_exact(width)
            .zip(attended.chunks_exact_mut(width));
        for (head, (query, attended)) in heads.enumerate() {
            let bias = layer.relative_bias.row(head, SPAN);
            self.attend_head(head, query, bias, newest, filled, attended);
        }
        linear_of_token(&layer.out, &[attended], h, add);
    }

    /// Quantizes a key and a value, head by head, into slot `slot`.
    #[inline]
    fn remember(&mut self, slot: usize, key: &[f32; D], value: &[f32; D]) {
        let width = const { D / HEADS };
        let scales = &mut self.key_scales[slot];
        let heads = key
            .chunks_exact(width)
            .zip(self.keys[slot].chunks_exact_mut(width));
        for ((key, codes), scale) in heads.zip(scales) {
            *scale = Active::quantize(key, KEY_LIMIT, codes);
        }
        let mut codes = [0; D];
        let scales = &mut self.value_scales[slot];
        let heads = value.chunks_exact(width).zip(codes.chunks_exact_mut(width));
        for ((value, codes), scale) in heads.zip(scales) {
            *scale = Active::quantize(value, KEY_LIMIT, codes);
        }
        for (channel, code) in self.values.iter_mut().zip(codes) {
            channel[slot] = code;
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
        bias: Floats<'_>,
        newest: usize,
        filled: usize,
        attended: &mut [f32],
    ) {
        let width = const { D / HEADS };
        let mut codes = [0; D];
        let query_codes = &mut codes[..width];
        let scale =
            Active::quantize(query, QUERY_LIMIT, query_codes) * inverse_square_root(width as f32);

        let mut scores = [0.0; SPAN];
        let mut largest = f32::MIN;
        let ages = slots_from::<SPAN>(newest).take(filled).zip(bias.iter());
        for ((slot, bias), score) in ages.zip(&mut scores) {
            let key = &self.keys[slot][head * width..(head + 1) * width];
            let product = Active::dot(query_codes, key) as f32;
            *score = product * (scale * self.key_scales[slot][head]) + bias;
            if *score > largest {
                largest = *score;
            }
        }

        // The weights stay unnormalised and take up the scale of their value; what is divided by
        // their sum is the one factor of the result.
        let mut sum = 0.0;
        let mut folded = [0.0; SPAN];
        for (slot, score) in slots_from::<SPAN>(newest).take(filled).zip(&scores) {
            let weight = exp(score - largest);
            sum += weight;
            folded[slot] = weight * self.value_scales[slot][head];
        }
        let mut weights = [0; SPAN];
        let scale = Active::quantize(&folded, QUERY_LIMIT, &mut weights) / sum;

        let values = &self.values[head * width..(head + 1) * width];
        for (attended, channel) in attended.iter_mut().zip(values) {
            *attended = Active::dot(&weights, channel) as f32 * scale;
        }
    }
}

/// The slots from the newest patch back.
#[inline]
fn slots_from<const SPAN: usize>(newest: usize) -> impl Iterator<Item = usize> {
    (0..=newest).rev().chain((newest + 1..SPAN).rev())
}
