//! Softmax over a row of attention scores, as loops that the compiler vectorizes.

use super::exponential::exp_negative;
use super::fold;

/// Softmax statistics of a row of scores `x`, whose weights are `exp((x - max) * scale) * inverse_sum`.
///
/// The sum in logarithmic form, one f32 number, would not reproduce the weights.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowStatistics {
    /// The largest score.
    pub max: f32,
    /// Reciprocal of the sum of the exponentials.
    pub inverse_sum: f32,
}

/// Replaces a row's scores by their exponentials: the weights, not yet multiplied by `inverse_sum`.
#[inline(always)]
pub(crate) fn exponentials(row: &mut [f32], scale: f32) -> RowStatistics {
    let max = fold(row, f32::NEG_INFINITY, |a, b| if a > b { a } else { b });
    for x in row.iter_mut() {
        *x = exp_negative((*x - max) * scale);
    }
    let inverse_sum = 1.0 / fold(row, 0.0, |a, b| a + b);
    RowStatistics { max, inverse_sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_the_softmax_of_the_scores() {
        let scores: Vec<f32> = (0..37).map(|i| ((i * 29) % 31) as f32 - 11.0).collect();
        let mut row = scores.clone();
        let statistics = exponentials(&mut row, 0.3);
        assert_eq!(statistics.max, 19.0);
        let naive: Vec<f64> = scores.iter().map(|&x| (f64::from(x) * 0.3).exp()).collect();
        let total: f64 = naive.iter().sum();
        for (found, expected) in row.iter().zip(naive) {
            assert!((f64::from(found * statistics.inverse_sum) - expected / total).abs() < 1e-6);
        }
    }
}
