//! The feed-forward half of a layer.

use super::{
    linear::{add, linear_of_token, replace},
    norm::normalise,
};
use crate::{arithmetic::gelu, model_file::LayerWeights};

/// `h += W_2 gelu(W_1 norm2(h) + b_1) + b_2`; twice the width inside.
#[inline]
pub fn feed_forward<const D: usize>(layer: &LayerWeights<'_>, h: &mut [f32; D]) {
    let token = normalise(&layer.norm2, h);
    let mut hidden = [[0.0; D]; 2];
    let activate = |place: &mut f32, value| replace(place, gelu(value));
    linear_of_token(&layer.ff1, &[token], hidden.as_flattened_mut(), activate);
    linear_of_token(&layer.ff2, &hidden, h, add);
}
