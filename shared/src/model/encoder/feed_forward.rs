//! The feed-forward half of a layer.

use super::{
    linear::{self, Added, Mapped, quantize},
    token::{Token, layer_norm},
};
use crate::arithmetic::gelu;
use crate::model::file::LayerWeights;

/// `h += W_2 gelu(W_1 norm2(h) + b_1) + b_2`, with twice the width between the two maps.
// A call instead of inlined copies, as in `attention`.
#[inline(never)]
pub(super) fn feed_forward<const T: usize, const WIDTH: usize>(
    layer: &LayerWeights<'_>,
    width: usize,
    tokens: &mut [Token<WIDTH>; T],
) {
    let inside = tokens.each_mut().map(|token| {
        let normalised = &mut token.normalised[..width];
        layer_norm(&layer.norm2, &token.residual[..width], normalised);
        Mapped {
            token: quantize(&layer.ff1, normalised, &mut token.codes),
            outputs: &mut token.wide.as_flattened_mut()[..2 * width],
        }
    });
    linear::map(&layer.ff1, inside);
    for token in &mut *tokens {
        for value in &mut token.wide.as_flattened_mut()[..2 * width] {
            *value = gelu(*value);
        }
    }
    let outside = tokens.each_mut().map(|token| Added {
        token: quantize(
            &layer.ff2,
            &token.wide.as_flattened()[..2 * width],
            &mut token.codes,
        ),
        sums: &mut token.sums[..width],
        residual: &mut token.residual[..width],
    });
    linear::add(&layer.ff2, outside);
}
