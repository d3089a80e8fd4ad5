//! Softmax over a row of scores, and back, as loops that a compiler turns into vector code.

use crate::teacher::exponential::exp_negative;

/// Independent sums of a row, so that additions need not wait for each other.
const LANES: usize = 16;

/// What makes weights of a row's scores `x`: `exp((x - top) * scale) * inverse`.
///
/// Kept in two numbers: their one logarithm would be too coarse to make the same weights again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Norm {
    /// The largest score.
    pub top: f32,
    /// One over the sum of the exponentials.
    pub inverse: f32,
}

/// Replaces a row's scores by weights that are yet to be multiplied by the norm's `inverse`.
#[inline(always)]
pub fn weigh(row: &mut [f32], scale: f32) -> Norm {
    let top = fold(row, f32::NEG_INFINITY, |a, b| if a > b { a } else { b });
    for x in row.iter_mut() {
        *x = exp_negative((*x - top) * scale);
    }
    let inverse = 1.0 / fold(row, 0.0, |a, b| a + b);
    Norm { top, inverse }
}

/// From a row's scores and the gradients of its used weights to what the products of the backward
/// pass need: the used weights, and the gradients of the scores.
///
/// A weight is used times its factor, which is 0 where it is dropped.
#[inline(always)]
pub fn unweigh(scores: &mut [f32], gradients: &mut [f32], factors: &[f32], norm: Norm, scale: f32) {
    for ((x, gradient), factor) in scores.iter_mut().zip(&mut *gradients).zip(factors) {
        *x = exp_negative((*x - norm.top) * scale) * norm.inverse;
        *gradient *= factor;
    }
    // Of the weights themselves, so that the gradients of a row add up to 0 but for rounding.
    let mean = dot(scores, gradients);
    for ((weight, gradient), factor) in scores.iter_mut().zip(gradients).zip(factors) {
        *gradient = *weight * (*gradient - mean) * scale;
        *weight *= factor;
    }
}

/// Sum of the products of two rows.
#[inline(always)]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f32 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f32>() + rest
}

#[inline(always)]
fn fold(row: &[f32], start: f32, join: impl Fn(f32, f32) -> f32) -> f32 {
    let mut lanes = [start; LANES];
    let chunks = row.chunks_exact(LANES);
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, &x) in lanes.iter_mut().zip(chunk) {
            *lane = join(*lane, x);
        }
    }
    rest.iter().chain(&lanes).fold(start, |a, &b| join(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_a_softmax() {
        let scores: Vec<f32> = (0..37).map(|i| ((i * 29) % 31) as f32 - 11.0).collect();
        let mut row = scores.clone();
        let norm = weigh(&mut row, 0.3);
        assert_eq!(norm.top, 19.0);
        let naive: Vec<f64> = scores.iter().map(|&x| (f64::from(x) * 0.3).exp()).collect();
        let total: f64 = naive.iter().sum();
        for (found, expected) in row.iter().zip(naive) {
            assert!((f64::from(found * norm.inverse) - expected / total).abs() < 1e-6);
        }
    }
}
