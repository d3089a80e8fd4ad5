//! z-scores: each feature's mean and standard deviation over the training windows, saved with the model.

use serde::{Deserialize, Serialize};

/// Scaling that subtracts each feature's mean and divides by its standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Scaling {
    mean: Vec<f32>,
    deviation: Vec<f32>,
}

impl Scaling {
    /// Fits to vectors of `features` values, or of several such groups (one per time step).
    ///
    /// It uses the population standard deviation. A constant feature is centred and not scaled.
    pub(super) fn fit<'a>(vectors: impl Iterator<Item = &'a [f32]>, features: usize) -> Self {
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

    /// Scales a vector in place.
    pub(super) fn apply(&self, vector: &mut [f32]) {
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
