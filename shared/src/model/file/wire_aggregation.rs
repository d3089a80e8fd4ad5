//! The aggregation mode as a postcard enum: modes with early labels have their margins behind it, those with caution one
//! more.
//!
//! Written by hand so that a file with a mode that is not known is refused with the mode's number.

use core::fmt;

use serde::de::{EnumAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::stream::smoother::{AggregationMode, Early};

/// Added to the mode of files with early labels; twice with caution.
const EARLY: u8 = 2;

/// Mode, and margins where labels are early: four, or five with caution.
#[derive(Clone, Copy)]
pub(super) struct WireAggregation {
    mode: u8,
    early: Option<Early>,
}

impl WireAggregation {
    #[cfg(any(test, feature = "write"))]
    pub(super) fn new(aggregation: AggregationMode, early: Option<Early>) -> Self {
        let mode = match aggregation {
            AggregationMode::AllRowsFrom => 0,
            AggregationMode::SameInstant => 1,
        };
        let plain = Self { mode, early: None };
        early.map_or(plain, |early| plain.with(early))
    }

    /// The mode with early labels.
    #[cfg(any(test, feature = "write"))]
    pub(super) fn with(self, early: Early) -> Self {
        let kind = if early.caution == 0.0 {
            EARLY
        } else {
            2 * EARLY
        };
        Self {
            mode: self.mode % EARLY + kind,
            early: Some(early),
        }
    }

    /// The mode and the margins, unchecked; the number of a mode that is not known.
    pub(super) fn interpret(self) -> Result<(AggregationMode, Option<Early>), u8> {
        match self.mode % EARLY {
            _ if self.mode >= 3 * EARLY => Err(self.mode),
            0 => Ok((AggregationMode::AllRowsFrom, self.early)),
            _ => Ok((AggregationMode::SameInstant, self.early)),
        }
    }

    #[cfg(test)]
    pub(super) const fn of_mode(mode: u8) -> Self {
        Self { mode, early: None }
    }
}

impl Serialize for WireAggregation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (name, mode) = ("", u32::from(self.mode));
        let Some(early) = self.early else {
            return serializer.serialize_unit_variant(name, mode, name);
        };
        let margins = early.margins();
        let [without @ .., _] = margins;
        if self.mode < 2 * EARLY {
            serializer.serialize_newtype_variant(name, mode, name, &without)
        } else {
            serializer.serialize_newtype_variant(name, mode, name, &margins)
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
        let margins = match mode / EARLY {
            1 => {
                let [entry, other, relax, leave] = behind.newtype_variant()?;
                Some([entry, other, relax, leave, 0.0])
            }
            2 => Some(behind.newtype_variant()?),
            _ => {
                behind.unit_variant()?;
                None
            }
        };
        let early = margins.map(Early::new);
        Ok(WireAggregation { mode, early })
    }
}
