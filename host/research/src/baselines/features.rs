//! Input features of the baselines, computed from one window of EMG.

use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, Sample};

use super::Baseline;
use super::windows::FrameLayout;
use execution::fingerprint::Fingerprint;

/// Conversion of a window's samples to a model's input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct FeatureExtraction {
    baseline: Baseline,
    lstm_step: usize,
    scaling: Option<Scaling>,
}

impl FeatureExtraction {
    pub(crate) const fn new(baseline: Baseline, lstm_step: usize) -> Self {
        Self {
            baseline,
            lstm_step,
            scaling: None,
        }
    }

    /// Fingerprint of a baseline that is trained with these features of these streams.
    pub(crate) fn lineage(&self, streams: Fingerprint) -> Fingerprint {
        Fingerprint::of(&(streams, self))
    }

    pub(crate) const fn is_scaled(&self) -> bool {
        matches!(self.baseline, Baseline::Lstm)
    }

    /// Fits the z-scores of each channel to the unscaled features of the training windows.
    pub(crate) fn with_scaling<'a>(self, windows: impl Iterator<Item = &'a [f32]>) -> Self {
        Self {
            scaling: Some(Scaling::fit(windows, CHANNELS)),
            ..self
        }
    }

    pub(crate) const fn frame_layout(&self) -> FrameLayout {
        FrameLayout::of(self.baseline, self.lstm_step)
    }

    /// Computes the model's input, 8 numbers per frame, oldest frame first, from a window of [`FrameLayout::window`] samples as
    /// the armband sends them.
    pub(crate) fn extract(&self, window: &[Sample]) -> Vec<f32> {
        let layout = self.frame_layout();
        let channels: Vec<Vec<f64>> = (0..CHANNELS)
            .map(|channel| {
                let x: Vec<i32> = window.iter().map(|own| i32::from(own[channel])).collect();
                match self.baseline {
                    Baseline::Lstm => moving_standard_deviations(&x, layout.starts(), layout.frame),
                    Baseline::EdTcn => {
                        moving_mean_absolute_values(&x, layout.starts(), layout.frame)
                    }
                }
            })
            .collect();
        let mut input: Vec<f32> = (0..layout.count)
            .flat_map(|frame| channels.iter().map(move |channel| channel[frame] as f32))
            .collect();
        if let Some(scaling) = &self.scaling {
            scaling.apply(&mut input);
        }
        input
    }
}

/// Standard deviation of each frame of `length` samples, given the frames' starts.
///
/// It is computed from integer prefix sums, so that overlapping frames cost no accuracy.
fn moving_standard_deviations(
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
fn moving_mean_absolute_values(
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

/// Scaling by z-scores: subtracts each feature's mean over the training windows and divides by its standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Scaling {
    mean: Vec<f32>,
    deviation: Vec<f32>,
}

impl Scaling {
    /// Fits to vectors of `features` values, or of several such groups (one per time step).
    ///
    /// It uses the population standard deviation. A constant feature is centred and not scaled.
    fn fit<'a>(vectors: impl Iterator<Item = &'a [f32]>, features: usize) -> Self {
        // Welford's algorithm: one pass, without the difference of large sums.
        let mut count = 0.0;
        let mut mean = vec![0.0_f64; features];
        let mut squares = vec![0.0_f64; features];
        for group in vectors.flat_map(|vector| vector.chunks_exact(features)) {
            count += 1.0;
            for ((mean, squares), &x) in mean.iter_mut().zip(&mut squares).zip(group) {
                let before = f64::from(x) - *mean;
                *mean += before / count;
                *squares += before * (f64::from(x) - *mean);
            }
        }
        let deviation = |squares: f64| {
            let deviation = (squares / f64::max(count, 1.0)).sqrt();
            if deviation > 1e-8 { deviation } else { 1.0 }
        };
        Self {
            mean: mean.iter().map(|&mean| mean as f32).collect(),
            deviation: squares.iter().map(|&s| deviation(s) as f32).collect(),
        }
    }

    fn apply(&self, vector: &mut [f32]) {
        for group in vector.chunks_exact_mut(self.mean.len()) {
            for ((x, mean), deviation) in group.iter_mut().zip(&self.mean).zip(&self.deviation) {
                *x = (*x - mean) / deviation;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extract(extraction: &FeatureExtraction) -> (Vec<f32>, Vec<Sample>) {
        let raw: Vec<Sample> = (0..extraction.frame_layout().window as i32)
            .map(|t| {
                std::array::from_fn(|c| ((37 * t * t + (11 + c as i32) * t) % 256 - 128) as i8)
            })
            .collect();
        (extraction.extract(&raw), raw)
    }

    fn channel(raw: &[Sample], channel: usize) -> Vec<i32> {
        raw.iter()
            .map(|sample| i32::from(sample[channel]))
            .collect()
    }

    #[test]
    fn features_have_their_documented_order() {
        let (lstm, raw) = extract(&FeatureExtraction::new(Baseline::Lstm, 10));
        assert_eq!(lstm.len(), 50 * 8);
        let newest = moving_standard_deviations(&channel(&raw, 3), std::iter::once(500), 100);
        assert_eq!(lstm[49 * 8 + 3], newest[0] as f32);

        let (tcn, raw) = extract(&FeatureExtraction::new(Baseline::EdTcn, 1));
        assert_eq!(tcn.len(), 20 * 8);
        let second = moving_mean_absolute_values(&channel(&raw, 5), std::iter::once(25), 150);
        assert_eq!(tcn[8 + 5], second[0] as f32);
    }

    #[test]
    fn scaling_survives_its_file() {
        let extraction = FeatureExtraction::new(Baseline::Lstm, 10);
        let (input, _) = extract(&extraction);
        let scaled = extraction.with_scaling(std::iter::once(input.as_slice()));
        let (again, _) = extract(&scaled);
        let mean = again.iter().sum::<f32>() / again.len() as f32;
        assert!(mean.abs() < 1e-4, "{mean}");
        let json = serde_json::to_string(&scaled).unwrap();
        assert_eq!(
            serde_json::from_str::<FeatureExtraction>(&json).unwrap(),
            scaled
        );
    }

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

    #[test]
    fn scaled_features_have_mean_zero_and_deviation_one() {
        let vectors: [[f32; 4]; 3] = [
            [1.0, 5.0, 2.0, 5.0],
            [4.0, 5.0, -1.0, 5.0],
            [9.0, 5.0, 0.5, 5.0],
        ];
        let scaling = Scaling::fit(vectors.iter().map(<[f32; 4]>::as_slice), 2);
        let scaled: Vec<[f32; 4]> = vectors
            .into_iter()
            .map(|mut vector| {
                scaling.apply(&mut vector);
                vector
            })
            .collect();
        let first: Vec<f32> = scaled.iter().flat_map(|v| [v[0], v[2]]).collect();
        let mean = first.iter().sum::<f32>() / 6.0;
        let square = first.iter().map(|x| x * x).sum::<f32>() / 6.0;
        assert!(
            mean.abs() < 1e-6 && (square - 1.0).abs() < 1e-5,
            "{first:?}"
        );
        // The second feature is 5 throughout.
        assert!(scaled.iter().all(|v| v[1] == 0.0 && v[3] == 0.0));
    }
}
