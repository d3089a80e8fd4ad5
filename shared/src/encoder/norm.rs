//! Layer norm.

use crate::{arithmetic::inverse_square_root, model_file::NormWeights};

/// Added to the variance, as in training.
const EPSILON: f32 = 1e-5;

/// `((h - mean) / sqrt(variance + 1e-5)) * gain + bias`, the variance over `D`.
///
/// Sums run from the first value to the last.
#[inline]
#[must_use]
pub fn normalise<const D: usize>(norm: &NormWeights<'_>, h: &[f32; D]) -> [f32; D] {
    let share = const { 1.0 / D as f32 };
    let mut mean = 0.0;
    for value in h {
        mean += value;
    }
    mean *= share;
    let mut variance = 0.0;
    for value in h {
        let distance = value - mean;
        variance += distance * distance;
    }
    let inverse = inverse_square_root(variance * share + EPSILON);
    let mut normalised = [0.0; D];
    let constants = norm.gain.iter().zip(norm.bias.iter());
    for ((place, value), (gain, bias)) in normalised.iter_mut().zip(h).zip(constants) {
        *place = (value - mean) * inverse * gain + bias;
    }
    normalised
}
