//! The aggregation mode as a postcard enum: modes with early labels have their margins behind it.
//!
//! Written by hand so that a file with a mode that is not known is refused with the mode's number.

use core::fmt;

use serde::de::{EnumAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::stream::smoother::{AggregationMode, Early};

/// Added to the mode of files with early labels.
const EARLY: u8 = 2;

/// Mode, and margins over the classes, over other movement and of relax where labels are early.
#[derive(Clone, Copy)]
pub(super) struct WireAggregation {
    mode: u8,
    margins: Option<[f32; 4]>,
}

impl WireAggregation {
    #[cfg(any(test, feature = "write"))]
    pub(super) fn new(aggregation: AggregationMode, early: Option<Early>) -> Self {
        let mode = match aggregation {
            AggregationMode::AllRowsFrom => 0,
            AggregationMode::SameInstant => 1,
        };
        Self {
            mode: mode + early.map_or(0, |_| EARLY),
            margins: early.map(Early::margins),
        }
    }

    /// The mode with early labels.
    #[cfg(any(test, feature = "write"))]
    pub(super) const fn with(self, early: Early) -> Self {
        Self {
            mode: self.mode % EARLY + EARLY,
            margins: Some(early.margins()),
        }
    }

    /// The mode and the margins, unchecked; the number of a mode that is not known.
    pub(super) fn interpret(self) -> Result<(AggregationMode, Option<Early>), u8> {
        let early = self.margins.map(Early::new);
        match self.mode % EARLY {
            _ if self.mode >= 2 * EARLY => Err(self.mode),
            0 => Ok((AggregationMode::AllRowsFrom, early)),
            _ => Ok((AggregationMode::SameInstant, early)),
        }
    }

    #[cfg(test)]
    pub(super) const fn of_mode(mode: u8) -> Self {
        Self {
            mode,
            margins: None,
        }
    }
}

impl Serialize for WireAggregation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (name, mode) = ("", u32::from(self.mode));
        match &self.margins {
            None => serializer.serialize_unit_variant(name, mode, name),
            Some(margins) => serializer.serialize_newtype_variant(name, mode, name, margins),
        }
    }
}

impl<'de> Deserialize<'de> for WireAggregation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("", &[], Mode)
    }
}

struct Mode;

impl<'de> Visitor<'de> for Mode {
    type Value = WireAggregation;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an aggregation mode")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<WireAggregation, A::Error> {
        let (mode, behind) = data.variant::<u8>()?;
        let margins = if (EARLY..2 * EARLY).contains(&mode) {
            Some(behind.newtype_variant()?)
        } else {
            behind.unit_variant()?;
            None
        };
        Ok(WireAggregation { mode, margins })
    }
}
