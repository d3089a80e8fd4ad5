//! Linear maps of quantized tokens.

use crate::model::file::LinearWeights;
use crate::model::kernels::{Active, Aligned, Kernels, TILE_ROWS, TOKEN_LIMIT};

/// Where one map after another puts the codes of its input, at most twice `D` of them.
pub type Codes<const D: usize> = Aligned<[[i16; D]; 2]>;

/// What a map reads: a token as `codes * scale`.
#[derive(Clone, Copy, Debug)]
pub struct Quantized<'c> {
    /// Its codes.
    pub codes: &'c [i16],
    /// What one of them counts.
    pub scale: f32,
}

/// Codes of a token, at most `2 D` long.
#[inline]
pub fn quantize<'c, const D: usize>(token: &[f32], codes: &'c mut Codes<D>) -> Quantized<'c> {
    let codes = &mut codes.0.as_flattened_mut()[..token.len()];
    let scale = Active::quantize(token, TOKEN_LIMIT, codes);
    Quantized { codes, scale }
}

/// A token and where its outputs go.
#[derive(Debug)]
pub struct Mapped<'t> {
    /// The token.
    pub token: Quantized<'t>,
    /// One place per row, and more up to a whole number of tiles: sums come to where their outputs will be.
    pub outputs: &'t mut [f32],
}

/// Gives every output of every token `y = finish(sum * (scale * row scale) + bias)`; the sum is exact in i32.
#[inline]
pub fn map<const T: usize>(
    map: &LinearWeights<'_>,
    mut tokens: [Mapped<'_>; T],
    finish: impl Fn(f32) -> f32,
) {
    let codes = tokens.each_ref().map(|mapped| mapped.token.codes);
    let sums = tokens
        .each_mut()
        .map(|mapped| bytemuck::cast_slice_mut(mapped.outputs));
    Active::multiply(map.weights, codes, sums);
    for Mapped { token, outputs } in tokens {
        for (output, (row_scale, bias)) in outputs.iter_mut().zip(map.scales.iter().zip(map.bias)) {
            let sum = output.to_bits().cast_signed();
            *output = finish(rescaled(sum, token.scale * row_scale, *bias));
        }
    }
}

/// A token and the residual stream that its outputs are added to.
#[derive(Debug)]
pub struct Added<'t, const D: usize> {
    /// The token.
    pub token: Quantized<'t>,
    /// Lent for the time.
    pub sums: &'t mut [i32; D],
    /// The residual stream.
    pub h: &'t mut [f32; D],
}

/// As [`map`], every output added to the residual stream.
#[inline]
pub fn add<const T: usize, const D: usize>(map: &LinearWeights<'_>, mut tokens: [Added<'_, D>; T]) {
    const { assert!(D.is_multiple_of(TILE_ROWS)) }
    let codes = tokens.each_ref().map(|added| added.token.codes);
    let sums = tokens.each_mut().map(|added| &mut added.sums[..]);
    Active::multiply(map.weights, codes, sums);
    for Added { token, sums, h } in tokens {
        let rows = h.iter_mut().zip(&*sums);
        for ((h, &sum), (row_scale, bias)) in rows.zip(map.scales.iter().zip(map.bias)) {
            *h += rescaled(sum, token.scale * row_scale, *bias);
        }
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
