//! Hand-crafted features of one channel, in the units of the samples: the networks' scalings take the
//! units out again.

use std::f64::consts::TAU;
use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

/// Root of the mean square.
#[must_use]
pub fn root_mean_square(x: &[i32]) -> f64 {
    let squares: i64 = x.iter().map(|&x| i64::from(x).pow(2)).sum();
    (squares as f64 / x.len() as f64).sqrt()
}

/// Mean squared distance from the mean (of the population: divided by n).
#[must_use]
pub fn variance(x: &[i32]) -> f64 {
    let sum: i64 = x.iter().map(|&x| i64::from(x)).sum();
    let squares: i64 = x.iter().map(|&x| i64::from(x).pow(2)).sum();
    spread(sum, squares, x.len())
}

/// Mean absolute value.
#[must_use]
pub fn mean_absolute(x: &[i32]) -> f64 {
    let sum: i64 = x.iter().map(|&x| i64::from(x).abs()).sum();
    sum as f64 / x.len() as f64
}

/// Sum of the steps from sample to sample, up or down.
#[must_use]
pub fn waveform_length(x: &[i32]) -> f64 {
    let sum: i64 = x
        .windows(2)
        .map(|pair| i64::from(pair[1] - pair[0]).abs())
        .sum();
    sum as f64
}

/// Samples that are above both neighbours or below both.
///
/// The reference's code counts the samples *between* their neighbours under this name: once
/// z-scored, the same feature with its sign turned, but for samples equal to a neighbour.
#[must_use]
pub fn slope_sign_changes(x: &[i32]) -> f64 {
    let turns = x
        .windows(3)
        .filter(|three| (three[1] - three[0]) * (three[1] - three[2]) > 0);
    turns.count() as f64
}

/// Neighbours of opposite sign; a 0 between them hides the crossing, as in the reference.
#[must_use]
pub fn zero_crossings(x: &[i32]) -> f64 {
    x.windows(2).filter(|pair| pair[0] * pair[1] < 0).count() as f64
}

/// Standard deviation over the `inner` samples from each start on.
///
/// From running integer sums, so that it is exact however many windows overlap.
#[must_use]
pub fn deviations(x: &[i32], starts: impl Iterator<Item = usize>, inner: usize) -> Vec<f64> {
    let (sums, squares) = (running(x, |x| x), running(x, |x| x * x));
    starts
        .map(|start| {
            let sum = sums[start + inner] - sums[start];
            let squares = squares[start + inner] - squares[start];
            spread(sum, squares, inner).sqrt()
        })
        .collect()
}

/// Mean absolute value over the `inner` samples from each start on.
#[must_use]
pub fn mean_absolutes(x: &[i32], starts: impl Iterator<Item = usize>, inner: usize) -> Vec<f64> {
    let sums = running(x, i64::abs);
    starts
        .map(|start| (sums[start + inner] - sums[start]) as f64 / inner as f64)
        .collect()
}

/// Sums of the first 0, 1, 2, ... values.
fn running(x: &[i32], of: impl Fn(i64) -> i64) -> Vec<i64> {
    let mut sum = 0;
    std::iter::once(0)
        .chain(x.iter().map(|&x| {
            sum += of(i64::from(x));
            sum
        }))
        .collect()
}

/// Variance of n integers from their sum and the sum of their squares, exact up to the division.
fn spread(sum: i64, squares: i64, n: usize) -> f64 {
    let n = n as i64;
    (n * squares - sum * sum) as f64 / (n * n) as f64
}

/// Amplitude spectrum through a Hamming window, of signals of one length.
pub struct Spectrum {
    transform: Arc<dyn RealToComplex<f64>>,
    hamming: Vec<f64>,
}

impl Spectrum {
    /// Plans the transform of `length` samples.
    #[must_use]
    pub fn new(length: usize) -> Self {
        let phase = |t: usize| TAU * t as f64 / length as f64;
        Self {
            transform: RealFftPlanner::new().plan_fft_forward(length),
            hamming: (0..length).map(|t| 0.54 - 0.46 * phase(t).cos()).collect(),
        }
    }

    /// Median amplitude over the frequencies from 0 to half the sample rate.
    ///
    /// # Panics
    /// When the signal is not as long as planned.
    #[must_use]
    pub fn median(&self, x: &[i32]) -> f64 {
        assert_eq!(x.len(), self.hamming.len(), "one length a plan");
        let mut signal: Vec<f64> = x
            .iter()
            .zip(&self.hamming)
            .map(|(&x, weight)| f64::from(x) * weight)
            .collect();
        let mut spectrum = self.transform.make_output_vec();
        self.transform
            .process(&mut signal, &mut spectrum)
            .expect("input and output have the planned lengths");
        let mut amplitudes: Vec<f64> = spectrum.into_iter().map(Complex::norm).collect();
        amplitudes.sort_by(f64::total_cmp);
        let middle = amplitudes.len() / 2;
        if amplitudes.len() % 2 == 1 {
            amplitudes[middle]
        } else {
            f64::midpoint(amplitudes[middle - 1], amplitudes[middle])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!(
            (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
            "{found} against {expected}"
        );
    }

    /// A signal that turns, crosses zero, rests and saturates.
    fn signal() -> Vec<i32> {
        (0..600_i32)
            .map(|t| ((37 * t * t + 11 * t) % 256 - 128) * i32::from(t % 50 > 4))
            .collect()
    }

    #[test]
    fn amplitudes_are_those_of_the_formulas() {
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
        close(mean_absolute(&x), mean(&mut floats.iter().map(|x| x.abs())));
        let mut length = 0.0;
        for t in 1..600 {
            length += (floats[t] - floats[t - 1]).abs();
        }
        close(waveform_length(&x), length);
    }

    #[test]
    fn turns_and_crossings_are_counted_one_by_one() {
        // Up, down through zero, flat, up through zero, flat at the top, down.
        let x = [0, 5, -3, -3, 4, 9, 9, 2, 0, -1];
        close(slope_sign_changes(&x), 1.0);
        close(zero_crossings(&x), 2.0);
        close(slope_sign_changes(&[1, 2, 1, 2, 3]), 2.0);
        close(zero_crossings(&[1, 0, -1]), 0.0);
    }

    #[test]
    fn moving_features_are_the_features_of_each_piece() {
        let x = signal();
        let starts = || (0..=500).step_by(7);
        let found = deviations(&x, starts(), 100);
        for (start, found) in starts().zip(found) {
            close(found, variance(&x[start..start + 100]).sqrt());
        }
        let found = mean_absolutes(&x, starts(), 100);
        for (start, found) in starts().zip(found) {
            close(found, mean_absolute(&x[start..start + 100]));
        }
    }

    #[test]
    fn the_spectrum_is_the_sum_over_waves() {
        for length in [24, 30] {
            let x = &signal()[100..100 + length];
            let mut amplitudes: Vec<f64> = (0..=length / 2)
                .map(|wave| {
                    let (mut real, mut imaginary) = (0.0, 0.0);
                    for (t, &x) in x.iter().enumerate() {
                        let turn = t as f64 / length as f64;
                        let weighted = f64::from(x) * (0.54 - 0.46 * (TAU * turn).cos());
                        real += weighted * (TAU * turn * wave as f64).cos();
                        imaginary += weighted * (TAU * turn * wave as f64).sin();
                    }
                    real.hypot(imaginary)
                })
                .collect();
            amplitudes.sort_by(f64::total_cmp);
            // 13 frequencies have a middle one, 16 have two.
            let expected = match length {
                24 => amplitudes[6],
                _ => (amplitudes[7] + amplitudes[8]) / 2.0,
            };
            close(Spectrum::new(length).median(x), expected);
        }
    }

    #[test]
    fn the_spectrums_median_is_that_of_scipy() {
        // scipy 1.17.1, numpy 2.4.6: median(abs(rfft(x * get_window("hamming", 600)))) of this x / 128.
        let x: Vec<i32> = (0..600).map(|t| (37 * t * t + 11 * t) % 129).collect();
        close(Spectrum::new(600).median(&x) / 128.0, 1.275_763_646_246_561);
    }
}
