//! Time-domain features of one channel, in the units of its samples; z-scores remove the unit later.

/// Root mean square.
pub(super) fn root_mean_square(x: &[i32]) -> f64 {
    let squares: i64 = x.iter().map(|&x| i64::from(x).pow(2)).sum();
    (squares as f64 / x.len() as f64).sqrt()
}

/// Population variance.
pub(super) fn variance(x: &[i32]) -> f64 {
    let sum: i64 = x.iter().map(|&x| i64::from(x)).sum();
    let squares: i64 = x.iter().map(|&x| i64::from(x).pow(2)).sum();
    variance_from_sums(sum, squares, x.len())
}

/// Mean absolute value.
pub(super) fn mean_absolute_value(x: &[i32]) -> f64 {
    let sum: i64 = x.iter().map(|&x| i64::from(x).abs()).sum();
    sum as f64 / x.len() as f64
}

/// Waveform length: the sum of absolute differences between consecutive samples.
pub(super) fn waveform_length(x: &[i32]) -> f64 {
    let sum: i64 = x
        .windows(2)
        .map(|pair| i64::from(pair[1] - pair[0]).abs())
        .sum();
    sum as f64
}

/// Slope sign changes: the number of strict local extrema.
///
/// The reference's code instead counts the samples strictly *between* their neighbours under this name. After z-scoring,
/// that is the same feature with the opposite sign, except for samples equal to a neighbour.
pub(super) fn slope_sign_changes(x: &[i32]) -> f64 {
    let extrema = x
        .windows(3)
        .filter(|three| (three[1] - three[0]) * (three[1] - three[2]) > 0);
    extrema.count() as f64
}

/// Zero crossings: the number of consecutive samples with opposite sign. As in the reference, a crossing through a sample
/// of 0 does not count.
pub(super) fn zero_crossings(x: &[i32]) -> f64 {
    x.windows(2).filter(|pair| pair[0] * pair[1] < 0).count() as f64
}

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
    use super::super::fixture::{close, signal};
    use super::*;

    #[test]
    fn amplitude_features_follow_their_formulas() {
        let x = signal();
        let floats: Vec<f64> = x.iter().map(|&x| f64::from(x)).collect();
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / 600.0;
        let average = mean(&mut floats.iter().copied());
        close(
            root_mean_square(&x),
            mean(&mut floats.iter().map(|x| x * x)).sqrt(),
        );
        close(
            variance(&x),
            mean(&mut floats.iter().map(|x| (x - average).powi(2))),
        );
        close(
            mean_absolute_value(&x),
            mean(&mut floats.iter().map(|x| x.abs())),
        );
        let mut length = 0.0;
        for t in 1..600 {
            length += (floats[t] - floats[t - 1]).abs();
        }
        close(waveform_length(&x), length);
    }

    #[test]
    fn extrema_and_zero_crossings_are_counted() {
        // Up, down through zero, constant, up through zero, constant, down through a sample of 0.
        let x = [0, 5, -3, -3, 4, 9, 9, 2, 0, -1];
        close(slope_sign_changes(&x), 1.0);
        close(zero_crossings(&x), 2.0);
        close(slope_sign_changes(&[1, 2, 1, 2, 3]), 2.0);
        close(zero_crossings(&[1, 0, -1]), 0.0);
    }

    #[test]
    fn moving_features_are_the_features_of_each_frame() {
        let x = signal();
        let starts = || (0..=500).step_by(7);
        let found = moving_standard_deviations(&x, starts(), 100);
        for (start, found) in starts().zip(found) {
            close(found, variance(&x[start..start + 100]).sqrt());
        }
        let found = moving_mean_absolute_values(&x, starts(), 100);
        for (start, found) in starts().zip(found) {
            close(found, mean_absolute_value(&x[start..start + 100]));
        }
    }
}
