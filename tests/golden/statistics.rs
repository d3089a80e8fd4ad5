//! Comparison of two samples: do they come from one distribution?
//!
//! Two samples of one distribution differ by chance. Every figure must agree within a number of standard errors of the
//! difference. The errors come from the spread of our own draws, whose seed is fixed.

use serde_json::Value;

/// Largest difference in standard errors: all of some 1500 figures are within them with a probability of 0.99.
const ERRORS: f64 = 4.5;

/// Comparison with the file: the figure's name, and the number of draws behind the file's figure.
pub struct Figure<'a> {
    pub name: String,
    pub draws: f64,
    pub expected: &'a Value,
    /// Half of the last digit that the file gives.
    pub rounding: f64,
}

impl Figure<'_> {
    /// Standard error of the difference of two means, of draws of this deviation.
    pub fn error(&self, deviation: f64, draws: usize) -> f64 {
        deviation * (1.0 / draws as f64 + 1.0 / self.draws).sqrt()
    }

    /// Compares a figure of this standard error.
    pub fn within(&self, found: f64, error: f64) {
        let expected = self.expected.as_f64().unwrap();
        assert!(
            (found - expected).abs() <= ERRORS * error + self.rounding,
            "{}: {found:.5}, expected {expected:.5} with a standard error of {error:.5}",
            self.name
        );
    }

    /// Compares a mean, of one value a draw.
    pub fn mean(&self, values: &[f64]) {
        self.within(mean(values), self.error(deviation(values), values.len()));
    }

    /// Compares a share of draws. The error is pooled, so that a value one side never drew is judged too.
    pub fn probability(&self, found: usize, of: usize) {
        let expected = self.expected.as_f64().unwrap();
        let pooled = (found as f64 + expected * self.draws) / (of as f64 + self.draws);
        let deviation = (pooled * (1.0 - pooled)).sqrt();
        self.within(found as f64 / of as f64, self.error(deviation, of));
    }

    /// Compares a ratio of two sums over masks. Runs of one mask resemble each other: the spread is that of masks.
    pub fn ratio(&self, above: &[f64], below: &[f64]) {
        let ratio = mean(above) / mean(below);
        let residuals: Vec<f64> = above
            .iter()
            .zip(below)
            .map(|(a, b)| a - ratio * b)
            .collect();
        let error = self.error(deviation(&residuals), above.len()) / mean(below);
        self.within(ratio, error);
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation of a sample.
pub fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (squares / values.len() as f64).sqrt()
}
