//! Calibration: the last layer of a model learnt anew from a few seconds of its wearer.
//!
//! ```text
//! hidden vector, class that the wearer was asked for -> Sums -> solve -> Head -> Encoder::with_head
//!                                                                           record -> kept over a loss of power
//! Session: cues, what the wearer is asked for, and how the armband sits; Judgement: whether the new head is used
//! ```
//!
//! The encoder stays as it is. The hidden vector of each patch that is shown, the head's input with a 1 behind it, is
//! added to [`Sums`]. [`solve`] finds the head `W` that minimizes
//!
//! > mean of (W x - t)^2 over the shown patches, each class weighing the same, + s (W - W_0)^2,
//!
//! ridge regression towards the model's own head `W_0`; `t` are the target logits of the class shown. The penalty `s` keeps
//! the weights that no shown patch determines. One matrix serves all six rows of the head: the class is the same throughout
//! a hold. No heap, no clock; the order of all operations is fixed, so every target computes the same bits.
//!
//! Constants and what they were measured against: docs/calibration.md.

mod judgement;
mod record;
mod session;
mod solve;
mod sums;

pub use judgement::Judgement;
pub use record::{KeptHead, RECORD_BYTES, RecordError, from_record, to_record};
pub(crate) use session::REACTION;
pub use session::{Activity, CalibrationProgress, CalibrationSession};
pub(crate) use solve::solve_from;
pub use solve::{SCRATCH, solve};
pub use sums::{Shown, Sums};

use crate::intent::Intent;
use crate::model::head::{Head, MAX_HEAD_WIDTH};
use crate::stream::alignment::{Alignment, NAT};

/// Fewest patches of each class, and of other movement if it is shown: those that lie whole in half a second.
pub const FEWEST_PATCHES: u32 = 9;
/// Excess distance from the template, over the nearest placement's, up to which an opening of a calibration leaves the
/// placement in force.
pub const FAVOUR: u32 = 2 * NAT;
/// Most patches of a hold that a calibration learns from: 3 s.
pub const MOST_PATCHES: usize = 60;

/// Memory of a calibration on a device, all zeros at first.
#[derive(Debug)]
pub struct Memory {
    pub(crate) sums: Sums,
    pub(crate) head: Head,
    pub(crate) alignment: Alignment,
}

impl Memory {
    /// Memory before the first calibration.
    pub const EMPTY: Self = Self {
        sums: Sums::EMPTY,
        head: Head::EMPTY,
        alignment: Alignment::NONE,
    };

    /// Head that was learnt.
    #[must_use]
    pub const fn head(&self) -> &Head {
        &self.head
    }

    /// Alignment under which it was learnt.
    #[must_use]
    pub const fn alignment(&self) -> Alignment {
        self.alignment
    }

    /// Record of the head that was learnt, for the model with this CRC-32; from the start of a word. The sums are lost.
    #[must_use]
    pub fn record(&mut self, model: u32) -> &[u8] {
        let bytes = bytemuck::cast_slice_mut(&mut self.sums.products);
        bytes.first_chunk_mut().map_or(&[], |bytes| {
            to_record(&self.head, self.alignment, model, bytes)
        })
    }
}

// The record has room in the sums.
const _: () = assert!(RECORD_BYTES <= 4 * SCRATCH);

/// Reason why a calibration learns nothing.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Refusal {
    #[error(
        "the model has width {found}, at most {MAX_HEAD_WIDTH} can be calibrated: take a smaller model"
    )]
    TooWide { found: usize },
    #[error("{} was shown for {found} patches of 50 ms, {FEWEST_PATCHES} are needed: show it longer", .class.name())]
    TooFew { class: Intent, found: u32 },
    #[error(
        "other movement was shown for {found} patches of 50 ms, {FEWEST_PATCHES} are needed: show it longer, or none"
    )]
    TooFewOthers { found: u32 },
    #[error("the hidden vectors are not of this model: show everything again")]
    WrongModel,
    #[error("what was shown gives no usable weights: show everything again")]
    NotFinite,
}

#[cfg(test)]
mod tests;
