//! Features of the frames of one channel, in the units of its samples; z-scores remove the unit later.

/// Standard deviation of each frame of `length` samples, given the frames' starts.
///
/// It is computed from integer prefix sums, so that overlapping frames cost no accuracy.
pub(super) fn moving_standard_deviations(
    x: &[i32],
    starts: impl Iterator<Item = usize>,
    length: usize,
) -> Vec<f64> {
    let (sums, squares) = (prefix_sums(x, |x| x), prefix_sums(x, |x| x * x));
    starts
        .map(|start| {
            let sum = sums[start + length] - sums[start];
            let squares = squares[start + length] - squares[start];
            variance_from_sums(sum, squares, length).sqrt()
        })
        .collect()
}

/// Mean absolute value of each frame of `length` samples, given the frames' starts.
pub(super) fn moving_mean_absolute_values(
    x: &[i32],
    starts: impl Iterator<Item = usize>,
    length: usize,
) -> Vec<f64> {
    let sums = prefix_sums(x, i64::abs);
    starts
        .map(|start| (sums[start + length] - sums[start]) as f64 / length as f64)
        .collect()
}

/// Sums of `of` over the first 0, 1, 2, ... samples.
fn prefix_sums(x: &[i32], of: impl Fn(i64) -> i64) -> Vec<i64> {
    let mut sum = 0;
    std::iter::once(0)
        .chain(x.iter().map(|&x| {
            sum += of(i64::from(x));
            sum
        }))
        .collect()
}

/// Population variance of n integers from their sum and the sum of their squares; exact up to the division.
fn variance_from_sums(sum: i64, squares: i64, n: usize) -> f64 {
    let n = n as i64;
    (n * squares - sum * sum) as f64 / (n * n) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moving_features_are_the_features_of_each_frame() {
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0));
        };
        // Extrema, zero crossings, zeros and full-scale values.
        let x: Vec<i32> = (0..600_i32)
            .map(|t| ((37 * t * t + 11 * t) % 256 - 128) * i32::from(t % 50 > 4))
            .collect();
        let mean = |of: &dyn Fn(f64) -> f64, start: usize| {
            let frame = x[start..start + 100].iter();
            frame.map(|&x| of(f64::from(x))).sum::<f64>() / 100.0
        };
        let starts = || (0..=500).step_by(7);
        let deviations = moving_standard_deviations(&x, starts(), 100);
        let values = moving_mean_absolute_values(&x, starts(), 100);
        for (start, (deviation, value)) in starts().zip(deviations.into_iter().zip(values)) {
            let average = mean(&|x| x, start);
            close(deviation, mean(&|x| (x - average).powi(2), start).sqrt());
            close(value, mean(&f64::abs, start));
        }
    }
}
