//! From the residual stream to the scores of the six newest patches.

use super::{
    Logits,
    linear::{linear_of_token, replace},
    norm::normalise,
};
use crate::{
    intent::MAX_CLASSES,
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
) -> Logits {
    let token = normalise(norm, h);
    let mut outputs = [0.0; LOOK_BACK * MAX_CLASSES];
    let outputs = &mut outputs[..LOOK_BACK * classes];
    linear_of_token(head, &[token], outputs, replace);
    let mut logits = Logits::default();
    for (row, outputs) in logits.iter_mut().zip(outputs.chunks_exact(classes)) {
        row[..classes].copy_from_slice(outputs);
    }
    logits
}
