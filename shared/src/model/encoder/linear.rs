//! Linear maps of quantized tokens.

use super::token::Codes;
use crate::kernels::{Active, Kernels, TOKEN_LIMIT};
use crate::model::file::LinearWeights;

/// The input of a linear map: a token as `codes * scale`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantized<'c> {
    pub codes: &'c [i16],
    pub scale: f32,
}

/// Quantizes a token of at most twice `WIDTH`.
#[inline]
pub(super) fn quantize<'c, const WIDTH: usize>(
    token: &[f32],
    codes: &'c mut Codes<WIDTH>,
) -> Quantized<'c> {
    let codes = &mut codes.0.as_flattened_mut()[..token.len()];
    let scale = Active::quantize(token, TOKEN_LIMIT, codes);
    Quantized { codes, scale }
}

/// A token and its outputs.
#[derive(Debug)]
pub(super) struct Mapped<'t> {
    pub token: Quantized<'t>,
    /// One element per row, rounded up to whole tiles: each holds its integer sum first.
    pub outputs: &'t mut [f32],
}

/// `y = finish(sum * (scale * row scale) + bias)` for every output of every token; the sum is exact
/// in i32.
#[inline]
pub(super) fn map<const T: usize>(
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

/// A token, and the residual stream that its outputs are added to.
#[derive(Debug)]
pub(super) struct Added<'t> {
    pub token: Quantized<'t>,
    /// Scratch memory, one element per row.
    pub sums: &'t mut [i32],
    pub residual: &'t mut [f32],
}

/// As [`map`], every output added to the residual stream.
#[inline]
pub(super) fn add<const T: usize>(map: &LinearWeights<'_>, mut tokens: [Added<'_>; T]) {
    let codes = tokens.each_ref().map(|added| added.token.codes);
    let sums = tokens.each_mut().map(|added| &mut *added.sums);
    Active::multiply(map.weights, codes, sums);
    for Added {
        token,
        sums,
        residual,
    } in tokens
    {
        let rows = residual.iter_mut().zip(&*sums);
        for ((residual, &sum), (row_scale, bias)) in rows.zip(map.scales.iter().zip(map.bias)) {
            *residual += rescaled(sum, token.scale * row_scale, *bias);
        }
    }
}

#[inline]
fn rescaled(sum: i32, scale: f32, bias: f32) -> f32 {
    sum as f32 * scale + bias
}

/// No activation function.
#[inline]
pub(super) fn identity(value: f32) -> f32 {
    value
}
