//! Windows in which a prediction has to change, and in which it has to hold.

use std::ops::Range;

use shared::intent::Intent;

/// Buffers and maintenance intervals of one labelled stretch.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Windows {
    /// First sample of every new label.
    pub changes: Vec<usize>,
    /// The buffer of each change.
    pub buffers: Vec<Range<usize>>,
    /// The interval from each buffer to the next; without any change, the whole stretch.
    pub maintenance: Vec<Range<usize>>,
}

impl Windows {
    /// Buffers of `width` samples, half of it on each side of a change, and the intervals between them.
    ///
    /// A buffer starts no earlier than the one before it ends. Where the next change is near, it stops one sample
    /// *before* the last sample of its label. Both rules are the reference's.
    #[must_use]
    pub fn new(truth: &[Intent], width: usize) -> Self {
        let half = width / 2;
        let samples = truth.len();
        let changes: Vec<usize> = (1..samples)
            .filter(|&at| truth[at] != truth[at - 1])
            .collect();
        let mut buffers: Vec<Range<usize>> = Vec::with_capacity(changes.len());
        for (index, &change) in changes.iter().enumerate() {
            let before = buffers.last().map_or(0, |buffer| buffer.end);
            let start = change.saturating_sub(half).max(before);
            let end = (change + half).min(samples);
            let end = match changes.get(index + 1) {
                Some(&next) if next <= end => next - 1,
                _ => end,
            };
            buffers.push(start..end);
        }
        let maintenance = if buffers.is_empty() {
            std::iter::once(0..samples).collect()
        } else {
            let next_starts = buffers.iter().skip(1).map(|b| b.start).chain([samples]);
            buffers
                .iter()
                .zip(next_starts)
                .map(|(buffer, next)| buffer.end..next)
                .collect()
        };
        Self {
            changes,
            buffers,
            maintenance,
        }
    }
}
