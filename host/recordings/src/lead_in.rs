//! The lead-in: a full window in front of a recording, for models that need one.
//!
//! It repeats the first patch, which every output of a model knows, and nothing later. So no output depends on
//! samples after its own patch. docs/decisions.md has what was measured.

use shared::units::{CleanSample, PATCH, WINDOW};

/// The stream with a full window in front: its first patch of 10 samples, sixty times.
///
/// Every model then has an output for every sample of a short recording, without samples after it.
#[must_use]
pub fn padded(emg: &[CleanSample]) -> Vec<CleanSample> {
    lead_in(emg, WINDOW)
}

/// A stream of any kind with `length` samples in front: its first patch, repeated.
#[must_use]
pub fn lead_in<T: Copy>(samples: &[T], length: usize) -> Vec<T> {
    let lead = &samples[..samples.len().min(PATCH)];
    lead.iter()
        .cycle()
        .take(if lead.is_empty() { 0 } else { length })
        .chain(samples)
        .copied()
        .collect()
}
