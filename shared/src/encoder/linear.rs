//! Linear maps of quantized tokens.

use crate::{
    kernels::{Active, Aligned, Kernels, TILE_ROWS, TOKEN_LIMIT},
    model_file::LinearWeights,
};

/// Where one map after another puts the codes of its input, at most twice `D` of them.
pub type Codes<const D: usize> = Aligned<[[i16; D]; 2]>;

/// Codes of a token and their scale: what a map reads.
///
/// `token` is at most `2 D` long.
#[inline]
pub fn quantize<'c, const D: usize>(token: &[f32], codes: &'c mut Codes<D>) -> (&'c [i16], f32) {
    let codes = &mut codes.0.as_flattened_mut()[..token.len()];
    let scale = Active::quantize(token, TOKEN_LIMIT, codes);
    (codes, scale)
}

/// Gives every output `y = finish(sum * (scale * row scale) + bias)`.
///
/// The input is `codes * scale`; the sum is exact in i32. `outputs` has one place per row, and more up to a whole
/// number of tiles: sums come to where their outputs will be.
#[inline]
pub fn map(
    map: &LinearWeights<'_>,
    (codes, scale): (&[i16], f32),
    outputs: &mut [f32],
    finish: impl Fn(f32) -> f32,
) {
    Active::multiply(map.weights, codes, bytemuck::cast_slice_mut(outputs));
    for (output, (row_scale, bias)) in outputs.iter_mut().zip(map.scales.iter().zip(map.bias)) {
        let sum = output.to_bits().cast_signed();
        *output = finish(rescaled(sum, scale * row_scale, *bias));
    }
}

/// As [`map`], every output added to `h`: the residual stream. `sums` is lent for the time.
#[inline]
pub fn add<const D: usize>(
    map: &LinearWeights<'_>,
    (codes, scale): (&[i16], f32),
    sums: &mut [i32; D],
    h: &mut [f32; D],
) {
    const { assert!(D.is_multiple_of(TILE_ROWS)) }
    Active::multiply(map.weights, codes, sums);
    let rows = h.iter_mut().zip(&*sums);
    for ((h, &sum), (row_scale, bias)) in rows.zip(map.scales.iter().zip(map.bias)) {
        *h += rescaled(sum, scale * row_scale, *bias);
    }
}

#[inline]
fn rescaled(sum: i32, scale: f32, bias: f32) -> f32 {
    sum as f32 * scale + bias
}

/// The output as it is.
#[inline]
pub fn as_is(value: f32) -> f32 {
    value
}
