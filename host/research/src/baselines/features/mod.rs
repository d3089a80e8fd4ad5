//! Input features of the baselines, computed from one window of EMG.

mod butterworth;
mod extraction;
mod scaling;
mod spectrum;
mod time_domain;

pub(super) use extraction::{FILTER_ORDERS, FeatureExtraction};

#[cfg(test)]
mod fixture {
    pub fn close(found: f64, expected: f64) {
        assert!(
            (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
            "{found} against {expected}"
        );
    }

    /// A signal with extrema, zero crossings, zeros and full-scale values.
    pub fn signal() -> Vec<i32> {
        (0..600_i32)
            .map(|t| ((37 * t * t + 11 * t) % 256 - 128) * i32::from(t % 50 > 4))
            .collect()
    }
}
