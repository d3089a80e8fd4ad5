//! Whether samples follow each other: by their index alone.

use shared::units::SampleIndex;

/// Most samples in a row that are bridged by repeating the last one: as many as a board bridges.
pub const BRIDGED: u32 = 5;

/// How samples follow those before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Continuity {
    /// Without a gap, or as the first.
    Next,
    /// After so few missing ones that they are bridged.
    Bridged(u32),
    /// After more missing ones: another recording.
    Lost(u32),
    /// The count went back: the board began anew, and nobody knows how much is missing.
    Restart,
}

/// The index that is due.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Continuous(Option<SampleIndex>);

impl Continuous {
    /// The index that is due; none before the first sample.
    #[must_use]
    pub const fn next(self) -> Option<SampleIndex> {
        self.0
    }

    /// Takes consecutive samples.
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
