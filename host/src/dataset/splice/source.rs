//! What is cut from, and what the cuts are joined to.

use std::ops::Range;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::Sample;

use crate::dataset::labels::lag;
use crate::dataset::recording::Recording;

/// A recording with the labels that the pieces carry.
pub(super) struct Source<'a> {
    samples: &'a [Sample],
    pub labels: Vec<Option<Intent>>,
}

impl<'a> Source<'a> {
    pub fn new(recording: &'a Recording, lag_samples: usize) -> Self {
        Self {
            samples: &recording.samples,
            labels: lag::compensated(&recording.labels, lag_samples),
        }
    }

    /// A random crop whose length is drawn from `lengths`; the whole source if it is shorter.
    pub fn crop(&self, lengths: Range<usize>, random: &mut ChaCha8Rng) -> Range<usize> {
        let all = self.samples.len();
        let length = random.random_range(lengths).min(all);
        let start = random.random_range(0..=all - length);
        start..start + length
    }
}

/// Cuts joined so far.
#[derive(Default)]
pub(super) struct Joined {
    pub samples: Vec<Sample>,
    pub labels: Vec<Option<Intent>>,
}

impl Joined {
    /// Appends a cut, up to `samples` in all.
    pub fn append(&mut self, source: &Source<'_>, cut: Range<usize>, samples: usize) {
        let end = cut.end.min(cut.start + samples - self.samples.len());
        self.samples
            .extend_from_slice(&source.samples[cut.start..end]);
        self.labels
            .extend_from_slice(&source.labels[cut.start..end]);
    }
}
