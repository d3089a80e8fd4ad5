//! The lead-in: a full window in front of a recording, for models that need one.

use shared::units::{CleanSample, WINDOW};

/// Samples that are repeated in front of a stream (as the reference does for its baselines).
const LEAD: usize = 100;

/// The stream with a full window in front: its first 100 samples, six times.
///
/// Every model then has an output for every sample of a short recording, without samples after it.
#[must_use]
pub fn padded(emg: &[CleanSample]) -> Vec<CleanSample> {
    lead_in(emg, WINDOW)
}

/// A stream of any kind with `length` samples in front: its first 100, repeated.
#[must_use]
pub fn lead_in<T: Copy>(samples: &[T], length: usize) -> Vec<T> {
    let lead = &samples[..samples.len().min(LEAD)];
    lead.iter()
        .cycle()
        .take(if lead.is_empty() { 0 } else { length })
        .chain(samples)
        .copied()
        .collect()
}
