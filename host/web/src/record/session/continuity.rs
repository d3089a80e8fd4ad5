//! Continuity of samples, by their index alone.

use shared::units::SampleIndex;

/// Greatest number of missing samples that are bridged by repeating the last one, as on a board.
const BRIDGED: u32 = 5;

/// Relation of samples to those before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Continuity {
    /// Samples follow without a gap, or are the first.
    Next,
    /// Samples follow a gap of this many, which is bridged.
    Bridged(u32),
    /// Samples follow a longer gap: another recording begins.
    Lost(u32),
    /// The index went back: the board has restarted, and the number of missing samples is unknown.
    Restart,
}

/// Whether a stream that has come to `index` has reached the sample `at`; correct across a wrap.
pub const fn has_reached(index: SampleIndex, at: SampleIndex) -> bool {
    index.0.wrapping_sub(at.0) <= u32::MAX / 2
}

/// Detector of gaps: the index that is due.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct IndexGapDetector(Option<SampleIndex>);

impl IndexGapDetector {
    /// Index that is due; none before the first sample.
    pub const fn next(self) -> Option<SampleIndex> {
        self.0
    }

    /// Takes consecutive samples and returns how they follow those before.
    pub fn take(&mut self, first: SampleIndex, count: u32) -> Continuity {
        let due = self.0.replace(first.plus(count));
        let Some(due) = due else {
            return Continuity::Next;
        };
        match first.0.wrapping_sub(due.0) {
            0 => Continuity::Next,
            missing @ 1..=BRIDGED => Continuity::Bridged(missing),
            missing if missing <= u32::MAX / 2 => Continuity::Lost(missing),
            _ => Continuity::Restart,
        }
    }
}
