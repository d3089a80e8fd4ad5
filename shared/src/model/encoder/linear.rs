//! Linear maps of quantized tokens.

use super::token::Codes;
use crate::kernels::{Active, Kernels, WEIGHT_ONE};
use crate::model::file::LinearWeights;

/// The input of a linear map: a token as `codes * scale * WEIGHT_ONE`. Products with the map's integers are in units of
/// `scale` times the row's scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantized<'c> {
    pub codes: &'c [i16],
    pub scale: f32,
}

/// Reciprocal of the integer of a weight of 1. Exact, and so is a product with it.
pub(super) const PER_WEIGHT: f32 = 1.0 / WEIGHT_ONE as f32;

/// Quantizes a token of at most twice `WIDTH` for a map.
#[inline]
pub(super) fn quantize<'c, const WIDTH: usize>(
    map: &LinearWeights<'_>,
    token: &[f32],
    codes: &'c mut Codes<WIDTH>,
) -> Quantized<'c> {
    let codes = &mut codes.0.as_flattened_mut()[..token.len()];
    let scale = Active::quantize(token, map.code_limit, codes) * PER_WEIGHT;
    Quantized { codes, scale }
}

/// A token and its outputs.
#[derive(Debug)]
pub(super) struct Mapped<'t> {
    pub token: Quantized<'t>,
    /// Outputs, one per row, rounded up to whole tiles: each element holds its integer sum first.
    pub outputs: &'t mut [f32],
}

/// `y = sum * (scale * row scale) + bias` for every output of every token; the sum is exact in i32.
#[inline]
pub(super) fn map<const T: usize>(map: &LinearWeights<'_>, mut tokens: [Mapped<'_>; T]) {
    let codes = tokens.each_ref().map(|mapped| mapped.token.codes);
    let sums = tokens
        .each_mut()
        .map(|mapped| bytemuck::cast_slice_mut(mapped.outputs));
    Active::multiply(map.weights, codes, sums);
    for Mapped { token, outputs } in tokens {
        Active::rescale(outputs, token.scale, map.scales, map.bias);
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

/// Like [`map`], but adds every output to the residual stream.
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
        Active::add_rescaled(sums, token.scale, map.scales, map.bias, residual);
    }
}
