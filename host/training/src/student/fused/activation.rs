//! GELU in its sigmoid approximation, `x sigmoid(1.702 x)`, and its slope.

use crate::optimization::kernels::exponential::exp_negative;
use crate::student::model::GELU_SCALE;

/// Writes the activation of `x`.
#[inline(always)]
pub(super) fn forward(x: &[f32], to: &mut [f32]) {
    for (to, &x) in to.iter_mut().zip(x) {
        *to = x * sigmoid(GELU_SCALE * x);
    }
}

/// Writes the activation of `x`, and its slope.
#[inline(always)]
pub(super) fn with_slope(x: &[f32], to: &mut [f32], slope: &mut [f32]) {
    for ((to, slope), &x) in to.iter_mut().zip(slope).zip(x) {
        let sigmoid = sigmoid(GELU_SCALE * x);
        *to = x * sigmoid;
        *slope = sigmoid + GELU_SCALE * *to * (1.0 - sigmoid);
    }
}

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    let small = exp_negative(-x.abs());
    let share = 1.0 / (1.0 + small);
    if x < 0.0 { small * share } else { share }
}
