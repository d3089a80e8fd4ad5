//! The aggregation mode as a postcard enum: modes with early labels have their margins behind it, those with caution one
//! more.

use serde::{Deserialize, Serialize};

use crate::stream::smoother::AggregationMode;
#[cfg(any(test, feature = "write"))]
use crate::stream::smoother::Early;

/// Mode, and the margins of early labels: over the classes, over other movement, of relax, of relax at any look-ahead, caution.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) enum WireAggregation {
    AllRowsFrom,
    SameInstant,
    AllRowsFromEarly([f32; 4]),
    SameInstantEarly([f32; 4]),
    AllRowsFromCautious([f32; 5]),
    SameInstantCautious([f32; 5]),
}

impl WireAggregation {
    #[cfg(any(test, feature = "write"))]
    pub(super) fn new(aggregation: AggregationMode, early: Option<Early>) -> Self {
        let without = early.map(|early| [early.entry, early.other, Early::RELAX, Early::LEAVE]);
        let caution = early.map_or(0.0, |early| early.caution);
        let all = aggregation == AggregationMode::AllRowsFrom;
        match without {
            None if all => Self::AllRowsFrom,
            None => Self::SameInstant,
            Some(without) if caution == 0.0 && all => Self::AllRowsFromEarly(without),
            Some(without) if caution == 0.0 => Self::SameInstantEarly(without),
            Some([entry, other, relax, leave]) => {
                let margins = [entry, other, relax, leave, caution];
                if all {
                    Self::AllRowsFromCautious(margins)
                } else {
                    Self::SameInstantCautious(margins)
                }
            }
        }
    }

    /// The mode and the margins, unchecked.
    pub(super) fn interpret(self) -> (AggregationMode, Option<[f32; 5]>) {
        let [all, same] = [AggregationMode::AllRowsFrom, AggregationMode::SameInstant];
        let cautious =
            |[entry, other, relax, leave]: [f32; 4]| Some([entry, other, relax, leave, 0.0]);
        match self {
            Self::AllRowsFrom => (all, None),
            Self::SameInstant => (same, None),
            Self::AllRowsFromEarly(margins) => (all, cautious(margins)),
            Self::SameInstantEarly(margins) => (same, cautious(margins)),
            Self::AllRowsFromCautious(margins) => (all, Some(margins)),
            Self::SameInstantCautious(margins) => (same, Some(margins)),
        }
    }
}
