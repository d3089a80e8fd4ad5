//! Runs of equal labels.

use std::ops::Range;

use shared::intent::Intent;

/// Longest possible run of one label: samples `start..end`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Run<L = Option<Intent>> {
    /// The label of every sample in it.
    pub label: L,
    /// First sample.
    pub start: usize,
    /// One after the last sample.
    pub end: usize,
}

impl<L> Run<L> {
    /// Number of samples, at least 1.
    pub const fn samples(&self) -> usize {
        self.end - self.start
    }

    /// Middle sample.
    pub(crate) const fn middle(&self) -> usize {
        usize::midpoint(self.start, self.end)
    }
}

/// The runs of a label sequence, in order and without gaps.
pub fn runs<L: Copy + PartialEq>(labels: &[L]) -> Vec<Run<L>> {
    let mut start = 0;
    labels
        .chunk_by(|a, b| a == b)
        .map(|chunk| {
            let run = Run {
                label: chunk[0],
                start,
                end: start + chunk.len(),
            };
            start = run.end;
            run
        })
        .collect()
}

/// Ranges of consecutive runs that are gestures, as indices of the runs.
pub(crate) fn holds<L>(runs: &[Run<L>], is_gesture: impl Fn(&Run<L>) -> bool) -> Vec<Range<usize>> {
    let mut from = 0;
    let alike = runs.chunk_by(|a, b| is_gesture(a) == is_gesture(b));
    let places = alike.map(|own| {
        from += own.len();
        from - own.len()..from
    });
    places.filter(|own| is_gesture(&runs[own.start])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_touch_and_cover_everything() {
        let labels = [None, None, Some(Intent::Open), None];
        let found = runs(&labels).into_iter().map(|r| (r.label, r.start..r.end));
        let expected = [(None, 0..2), (labels[2], 2..3), (None, 3..4)];
        assert!(found.eq(expected));
        assert!(runs::<Option<Intent>>(&[]).is_empty());
    }
}
