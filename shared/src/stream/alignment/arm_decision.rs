//! Decision between the arms, where the template cannot tell: the model's logits for the openings decide with it.
//!
//! The open hand of one person in eight is nearly symmetrical round the arm. Then the best placements of both arms are
//! nearly as near to the template, but the model does not take them for the same: it has seen more than the means of
//! electrodes. The encoder takes the same patches in both placements, one after the other, each from a fresh state; the
//! placement in which the logit of `open` is further above all others has the model's voice. Nats of the template and
//! logits are both logarithms of ratios of probabilities, so they are added, with a weight that was measured:
//! docs/alignment.md.
//!
//! The order of the sums is part of the definition: patches in time order, rows newest first, in f32.

use super::outcome::AlignmentOutcome;
use super::placement::Alignment;
use super::template::{Fits, NAT};
use crate::intent::{Intent, MAX_LOGITS};
use crate::units::{LOOK_BACK, PATCH, WINDOW_PATCHES};

/// Lead of a placement over those on the other arm that the model may overrule.
pub(super) const SURE: u32 = 4 * NAT;

/// Weight of a difference of one logit in the mean: 1.5 nats.
const WEIGHT: f32 = 1.5 * NAT as f32;

/// Most patches that the encoder takes in each placement: those that are still in the window when it takes the last
/// placement's first one.
const MOST: usize = 53;

// With a sample for each patch, MOST.div_ceil(PATCH) patches have come then; of a window of 60 one is being overwritten.
const _: () = assert!(MOST + (MOST + 1).div_ceil(PATCH) < WINDOW_PATCHES);

/// A decision in progress.
///
/// [`ArmDecision::next`] and [`ArmDecision::score`] are called once for each patch that the encoder takes: at most 106.
#[derive(Clone, PartialEq, Debug)]
pub struct ArmDecision {
    fits: Fits,
    /// Bits of the patches that are of the openings, the newest when it began in the lowest bit; 0 from `patches` on.
    opening: u64,
    /// Patches to be taken in each placement.
    patches: usize,
    /// Patches of these that are yet to be taken in the present placement.
    remaining: usize,
    /// Patches that have completed since it began.
    completed: usize,
    /// Total score of the nearest placement, once it is known.
    nearest_score: Option<f32>,
    /// Sum over rows that refer to the openings of how far `open` is above the other logits, in the present placement.
    score: f32,
    /// Number of these rows so far; as many in each placement.
    rows: u32,
}

/// Input for the encoder.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Next {
    /// Arrangement of the electrodes, seen from the alignment in force.
    pub alignment: Alignment,
    /// Patches from the newest complete one back to this one.
    pub back: usize,
    /// Whether the state is to be made fresh before.
    pub is_first: bool,
}

impl ArmDecision {
    /// A decision before the first patch. Bits of `active` mark the patches that were active in a gesture, the newest lowest.
    #[must_use]
    pub const fn new(fits: Fits, active: u64) -> Self {
        Self {
            fits,
            // The window's patches and the alignment's begin at different samples: each lies in two of the others.
            opening: active & (active >> 1),
            patches: 0,
            remaining: 0,
            completed: 0,
            nearest_score: None,
            score: 0.0,
            rows: 0,
        }
    }

    /// Sets out with the complete patches that the window holds: at least one, for it holds a gesture.
    pub fn start(&mut self, complete: usize) {
        self.patches = complete.clamp(1, MOST);
        self.remaining = self.patches;
        self.opening &= (1 << self.patches) - 1;
    }

    /// The best placements of both arms.
    #[must_use]
    pub const fn fits(&self) -> Fits {
        self.fits
    }

    /// Notes that the window has completed another patch.
    pub const fn patch_completed(&mut self) {
        self.completed += 1;
    }

    /// The next input for the encoder.
    #[must_use]
    pub const fn next(&self) -> Next {
        let fit = match self.nearest_score {
            None => self.fits.nearest,
            Some(_) => self.fits.other_arm,
        };
        Next {
            alignment: fit.alignment,
            back: self.completed + self.remaining - 1,
            is_first: self.remaining == self.patches,
        }
    }

    /// Takes the logits of the patch of [`ArmDecision::next`], of which `outputs` columns are the model's; returns the end.
    pub fn score(
        &mut self,
        rows: &[[f32; MAX_LOGITS]; LOOK_BACK],
        outputs: usize,
    ) -> Option<AlignmentOutcome> {
        self.remaining -= 1;
        for (back, row) in rows.iter().enumerate() {
            // Patches before the first one are in no bit.
            if self.opening >> (self.remaining + back) & 1 == 1 {
                self.score += evidence(&row[..outputs]);
                self.rows += 1;
            }
        }
        if self.remaining > 0 {
            return None;
        }
        let Some(nearest) = self.nearest_score else {
            self.nearest_score = Some(self.score);
            self.score = 0.0;
            self.rows = 0;
            self.remaining = self.patches;
            return None;
        };
        // The means' difference, times the number of rows: no division, and without a row the template decides.
        let is_overruled =
            WEIGHT * (self.score - nearest) > self.fits.lead() as f32 * self.rows as f32;
        let fit = if is_overruled {
            self.fits.other_arm
        } else {
            self.fits.nearest
        };
        Some(AlignmentOutcome::of(fit))
    }
}

/// Difference between the logit of `open` and the largest other one.
fn evidence(logits: &[f32]) -> f32 {
    let open = Intent::Open.class();
    let mut largest = f32::NEG_INFINITY;
    for (column, &logit) in logits.iter().enumerate() {
        if column != open && logit > largest {
            largest = logit;
        }
    }
    logits.get(open).map_or(0.0, |own| own - largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::alignment::{Fit, Poor};

    const NEAREST: Fit = Fit {
        alignment: Alignment::new(3, false),
        distance: 2 * NAT,
        margin: 5 * NAT,
    };
    /// 1 nat further.
    const OTHER_ARM: Fit = Fit {
        alignment: Alignment::new(5, true),
        distance: 3 * NAT,
        margin: 5 * NAT,
    };
    const FITS: Fits = Fits {
        nearest: NEAREST,
        other_arm: OTHER_ARM,
    };
    /// The ten newest patches but the two last are of an opening.
    const ACTIVE: u64 = 0x3FC;

    /// Logits in whose rows `open` is so far above the others of three classes, of which one is at -1.
    fn rows(lead: f32) -> [[f32; MAX_LOGITS]; LOOK_BACK] {
        [[-3.0, lead - 1.0, -1.0, 99.0, 99.0, 99.0, 99.0]; LOOK_BACK]
    }

    /// The outcome if `open` leads by so much in each placement.
    fn outcome(fits: Fits, active: u64, leads: [f32; 2]) -> Option<AlignmentOutcome> {
        let mut decision = ArmDecision::new(fits, active);
        decision.start(20);
        for lead in leads {
            for taken in 0..20 {
                let next = decision.next();
                assert_eq!((next.is_first, next.back), (taken == 0, 19 - taken));
                let outcome = decision.score(&rows(lead), 3);
                if outcome.is_some() {
                    assert_eq!(taken, 19);
                    return outcome;
                }
            }
        }
        None
    }

    #[test]
    fn a_logit_of_difference_outweighs_one_and_a_half_nats() {
        // 1 nat is 0.67 logits.
        for (leads, expected) in [
            ([0.0, 0.0], NEAREST),
            ([2.0, 2.6], NEAREST),
            ([2.0, 2.7], OTHER_ARM),
            ([-2.0, -1.3], OTHER_ARM),
            ([9.0, -9.0], NEAREST),
        ] {
            let expected = Some(AlignmentOutcome::Aligned(expected));
            assert_eq!(outcome(FITS, ACTIVE, leads), expected, "{leads:?}");
        }
    }

    #[test]
    fn without_an_opening_in_the_window_the_template_decides() {
        let older_than_twenty = ACTIVE << 20;
        for active in [0, 1, older_than_twenty] {
            let found = outcome(FITS, active, [-9.0, 9.0]);
            assert_eq!(found, Some(AlignmentOutcome::Aligned(NEAREST)));
        }
    }

    #[test]
    fn a_placement_that_is_poor_is_not_accepted_because_the_model_likes_it() {
        let other_arm = Fit {
            margin: NAT - 1,
            ..OTHER_ARM
        };
        let fits = Fits { other_arm, ..FITS };
        let found = outcome(fits, ACTIVE, [-9.0, 9.0]);
        assert_eq!(found, Some(AlignmentOutcome::Poor(other_arm, Poor::Margin)));
    }

    #[test]
    fn other_movement_is_one_of_the_logits_that_open_is_above() {
        assert_eq!(evidence(&[1.0, 3.0, -1.0]), 2.0);
        assert_eq!(evidence(&[1.0, 3.0, -1.0, 2.5]), 0.5);
    }
}
