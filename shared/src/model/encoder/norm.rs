//! Layer norm.

use crate::model::arithmetic::inverse_square_root;
use crate::model::file::NormWeights;

/// Added to the variance, as in training.
const EPSILON: f32 = 1e-5;

/// `normalised = ((h - mean) / sqrt(variance + 1e-5)) * gain + bias`, the variance over `D`.
///
/// Sums run from the first value to the last.
#[inline]
pub fn normalise<const D: usize>(norm: &NormWeights<'_>, h: &[f32; D], normalised: &mut [f32; D]) {
    let share = const { 1.0 / D as f32 };
    let mut mean = 0.0;
    for value in h {
        mean += value;
    }
    mean *= share;
    let mut variance = 0.0;
    for (place, value) in normalised.iter_mut().zip(h) {
        let distance = value - mean;
        *place = distance;
        variance += distance * distance;
    }
    let inverse = inverse_square_root(variance * share + EPSILON);
    let constants = norm.gain.iter().zip(norm.bias.iter());
    for (place, (gain, bias)) in normalised.iter_mut().zip(constants) {
        *place = *place * inverse * gain + bias;
    }
}
