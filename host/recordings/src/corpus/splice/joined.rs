//! Cuts of recordings, and the cuts joined so far.

use std::ops::Range;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::Sample;

use super::SpliceOptions;
use crate::recording::Recording;
use crate::recording::movement::{self, Movement};

/// A random crop of a recording whose length is drawn from `lengths`; the whole recording if it is shorter.
pub(super) fn crop(
    recording: &Recording,
    lengths: Range<usize>,
    random: &mut ChaCha8Rng,
) -> Range<usize> {
    let all = recording.samples.len();
    let length = random.random_range(lengths).min(all);
    let start = random.random_range(0..=all - length);
    start..start + length
}

/// Cuts joined so far.
#[derive(Default)]
pub(super) struct Joined {
    pub samples: Vec<Sample>,
    pub labels: Vec<Option<Intent>>,
    /// Movement outside the vocabulary, in order; empty if it is no class.
    pub other: Vec<Movement>,
}

impl Joined {
    /// Appends a cut, up to the length that is wanted.
    pub fn append(&mut self, recording: &Recording, cut: Range<usize>, options: &SpliceOptions) {
        let end = cut
            .end
            .min(cut.start + options.samples - self.samples.len());
        let (cut, joined) = (cut.start..end, self.labels.len());
        self.samples.extend(&recording.samples[cut.clone()]);
        self.labels.extend(&recording.labels[cut.clone()]);
        if !options.other {
            return;
        }
        for Movement { kind, samples } in movement::within(&recording.other_movement, &cut) {
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
