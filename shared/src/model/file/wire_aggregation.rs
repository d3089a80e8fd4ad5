//! The aggregation mode as a postcard enum: modes with early labels have their margins behind it, those with caution one
//! more.

use serde::{Deserialize, Serialize};

use crate::stream::smoother::{AggregationMode, Early};

/// Mode, and the margins of early labels in the order of [`Early::margins`].
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
        let margins = early.map(Early::margins);
        match (aggregation, margins) {
            (AggregationMode::AllRowsFrom, None) => Self::AllRowsFrom,
            (AggregationMode::SameInstant, None) => Self::SameInstant,
            (AggregationMode::AllRowsFrom, Some([without @ .., 0.0])) => {
                Self::AllRowsFromEarly(without)
            }
            (AggregationMode::SameInstant, Some([without @ .., 0.0])) => {
                Self::SameInstantEarly(without)
            }
            (AggregationMode::AllRowsFrom, Some(all)) => Self::AllRowsFromCautious(all),
            (AggregationMode::SameInstant, Some(all)) => Self::SameInstantCautious(all),
        }
    }

    /// The mode and the margins, unchecked.
    pub(super) fn interpret(self) -> (AggregationMode, Option<Early>) {
        let [all, same] = [AggregationMode::AllRowsFrom, AggregationMode::SameInstant];
        let without = |[entry, other, relax, leave]: [f32; 4]| {
            Some(Early::new([entry, other, relax, leave, 0.0]))
        };
        match self {
            Self::AllRowsFrom => (all, None),
            Self::SameInstant => (same, None),
            Self::AllRowsFromEarly(margins) => (all, without(margins)),
            Self::SameInstantEarly(margins) => (same, without(margins)),
            Self::AllRowsFromCautious(margins) => (all, Some(Early::new(margins))),
            Self::SameInstantCautious(margins) => (same, Some(Early::new(margins))),
        }
    }
}
