//! From the residual stream to the scores of the six newest patches.

use super::{
    Logits,
    linear::{self, as_is, quantize},
    norm::normalise,
    scratch::Scratch,
};
use crate::{
    intent::MAX_CLASSES,
    kernels::TILE_ROWS,
    model_file::{LinearWeights, NormWeights},
    units::LOOK_BACK,
};

/// `W_h norm(h) + b_h`: outputs `j classes .. (j + 1) classes` are row `j`.
#[inline]
#[must_use]
pub fn scores<const D: usize>(
    norm: &NormWeights<'_>,
    head: &LinearWeights<'_>,
    h: &[f32; D],
    classes: usize,
    scratch: &mut Scratch<D>,
) -> Logits {
    normalise(norm, h, &mut scratch.token);
    let token = quantize(&scratch.token, &mut scratch.codes);
    let mut outputs = [0.0; (LOOK_BACK * MAX_CLASSES).next_multiple_of(TILE_ROWS)];
    let rows = (LOOK_BACK * classes).next_multiple_of(TILE_ROWS);
    linear::map(head, token, &mut outputs[..rows], as_is);
    let mut logits = Logits::default();
    for (row, outputs) in logits.iter_mut().zip(outputs.chunks_exact(classes)) {
        row[..classes].copy_from_slice(outputs);
    }
    logits
}
