//! Layer norm.

use crate::arithmetic::inverse_square_root;
use crate::model::file::NormWeights;

/// Added to the variance, as in training.
const EPSILON: f32 = 1e-5;

/// `normalised = ((h - mean) / sqrt(variance + 1e-5)) * gain + bias`, the variance over all of `h`.
///
/// Sums run from the first value to the last.
#[inline]
pub(super) fn layer_norm(norm: &NormWeights<'_>, h: &[f32], normalised: &mut [f32]) {
    let share = 1.0 / h.len() as f32;
    let mut mean = 0.0;
    for value in h {
        mean += value;
    }
    mean *= share;
    let mut variance = 0.0;
    for (centred, value) in normalised.iter_mut().zip(h) {
        let difference = value - mean;
        *centred = difference;
        variance += difference * difference;
    }
    let inverse = inverse_square_root(variance * share + EPSILON);
    let constants = norm.gain.iter().zip(norm.bias.iter());
    for (value, (gain, bias)) in normalised.iter_mut().zip(constants) {
        *value = *value * inverse * gain + bias;
    }
}
