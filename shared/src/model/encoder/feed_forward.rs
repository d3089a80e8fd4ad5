//! The feed-forward half of a layer.

use super::{
    linear::{self, Added, Mapped, quantize},
    norm::normalise,
    token::Token,
};
use crate::model::arithmetic::gelu;
use crate::model::file::LayerWeights;

/// `h += W_2 gelu(W_1 norm2(h) + b_1) + b_2`; twice the width inside.
#[inline]
pub fn feed_forward<const T: usize, const D: usize>(
    layer: &LayerWeights<'_>,
    tokens: &mut [Token<D>; T],
) {
    let inside = tokens.each_mut().map(|token| {
        normalise(&layer.norm2, &token.h, &mut token.normalised);
        Mapped {
            token: quantize(&token.normalised, &mut token.codes),
            outputs: token.wide[..2].as_flattened_mut(),
        }
    });
    linear::map(&layer.ff1, inside, gelu);
    let outside = tokens.each_mut().map(|token| Added {
        token: quantize(token.wide[..2].as_flattened(), &mut token.codes),
        sums: &mut token.sums,
        h: &mut token.h,
    });
    linear::add(&layer.ff2, outside);
}
