//! Sources of the cuts, and the cuts joined so far.

use std::ops::Range;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::Sample;

use crate::recording::Recording;
use crate::recording::movement::{self, Movement};

/// A recording with the labels that the pieces carry.
pub(super) struct SpliceSource<'a> {
    samples: &'a [Sample],
    /// Labels; none in movement outside the vocabulary, so that it is spliced like a gesture and not like rest.
    pub labels: Vec<Option<Intent>>,
    /// Movement outside the vocabulary, in order; empty if it is no class.
    other: Vec<Movement>,
}

impl<'a> SpliceSource<'a> {
    pub fn new(recording: &'a Recording, other_is_a_class: bool) -> Self {
        let other_movement = recording.other_movement.iter();
        Self {
            samples: &recording.samples,
            labels: recording.labels.clone(),
            other: other_movement
                .filter(|_| other_is_a_class)
                .cloned()
                .collect(),
        }
    }

    /// Whether the whole source is movement outside the vocabulary that is a class.
    pub(crate) fn is_other_movement(&self) -> bool {
        let covered: usize = self.other.iter().map(|m| m.samples.len()).sum();
        covered > 0 && covered >= self.labels.len()
    }

    /// A random crop whose length is drawn from `lengths`; the whole source if it is shorter.
    pub(crate) fn crop(&self, lengths: Range<usize>, random: &mut ChaCha8Rng) -> Range<usize> {
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
    /// Movement outside the vocabulary that is a class.
    pub other: Vec<Movement>,
}

impl Joined {
    /// Appends a cut, up to `samples` in all.
    pub fn append(&mut self, source: &SpliceSource<'_>, cut: Range<usize>, samples: usize) {
        let end = cut.end.min(cut.start + samples - self.samples.len());
        self.samples
            .extend_from_slice(&source.samples[cut.start..end]);
        let joined = self.labels.len();
        self.labels
            .extend_from_slice(&source.labels[cut.start..end]);
        for Movement { kind, samples } in movement::within(&source.other, &(cut.start..end)) {
            let samples = joined + samples.start..joined + samples.end;
            match self.other.last_mut() {
                Some(last) if last.kind == kind && last.samples.end == samples.start => {
                    last.samples.end = samples.end;
                }
                _ => self.other.push(Movement::new(kind, samples)),
            }
        }
    }
}
