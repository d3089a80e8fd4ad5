//! Outcome of an alignment.

use super::template::{Fit, NAT};

/// Largest distance of a placement that is accepted.
const FURTHEST: u32 = 8 * NAT;
/// Least margin of a placement that is accepted.
const LEAST_MARGIN: u32 = NAT;

/// Outcome of an alignment.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AlignmentOutcome {
    /// The armband sits like this, seen from the alignment in force so far.
    Aligned(Fit),
    /// Nothing is to be changed.
    Poor(Fit, Poor),
    /// Too few gestures in 30 s.
    Timeout,
}

/// Why a placement is not accepted.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Poor {
    /// No placement looks like an open hand.
    Distance,
    /// Another placement, not beside it, looks nearly as much like one.
    Margin,
}

impl AlignmentOutcome {
    /// The outcome for the placement that was chosen.
    pub(super) const fn of(fit: Fit) -> Self {
        if fit.distance > FURTHEST {
            Self::Poor(fit, Poor::Distance)
        } else if fit.margin < LEAST_MARGIN {
            Self::Poor(fit, Poor::Margin)
        } else {
            Self::Aligned(fit)
        }
    }
}
