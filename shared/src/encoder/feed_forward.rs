//! The feed-forward half of a layer.

use super::{
    linear::{self, quantize},
    norm::normalise,
    scratch::Scratch,
};
use crate::{arithmetic::gelu, model_file::LayerWeights};

/// `h += W_2 gelu(W_1 norm2(h) + b_1) + b_2`; twice the width inside.
#[inline]
pub fn feed_forward<const D: usize>(
    layer: &LayerWeights<'_>,
    h: &mut [f32; D],
    scratch: &mut Scratch<D>,
) {
    let Scratch {
        token,
        wide,
        codes,
        sums,
        ..
    } = scratch;
    let hidden = wide[..2].as_flattened_mut();
    normalise(&layer.norm2, h, token);
    linear::map(&layer.ff1, quantize(token, codes), hidden, gelu);
    linear::add(&layer.ff2, quantize(hidden, codes), sums, h);
}
