//! Confidence gate that a contender is also evaluated with.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use shared::units::MAX_ENTRY_MARGIN;

/// Gate of all classes but relax.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Gate {
    /// Margin over the other classes.
    pub(crate) entry: f32,
    /// Margin over movement outside the vocabulary, for models that know it; none for the contender's own.
    pub(crate) other: Option<f32>,
    /// Margins of early labels: over classes, over other movement, of relax, of leaving, of caution; none if no label is early.
    #[serde(default)]
    pub(crate) early: Option<[f32; 5]>,
}

impl FromStr for Gate {
    type Err = String;

    /// Parses `1`, `1/0.5` or `1/0.5+0.5/1/2/0/8`.
    fn from_str(text: &str) -> Result<Self, String> {
        let margin = |text: &str, least: f32| {
            let margin = text.parse().ok();
            margin
                .filter(|margin| (least..=MAX_ENTRY_MARGIN).contains(margin))
                .ok_or_else(|| format!("`{text}`: expected {least} to {MAX_ENTRY_MARGIN}"))
        };
        let (gate, early) = match text.split_once('+') {
            Some((gate, early)) => (gate, Some(early)),
            None => (text, None),
        };
        let early = early.map(|early| {
            let margins = early.split('/').map(|text| margin(text, 0.0));
            let margins = margins.collect::<Result<Vec<_>, _>>()?;
            margins
                .try_into()
                .map_err(|_| format!("`{early}`: expected five margins of early labels"))
        });
        let (entry, other) = match gate.split_once('/') {
            Some((entry, other)) => (entry, Some(margin(other, -MAX_ENTRY_MARGIN)?)),
            None => (gate, None),
        };
        Ok(Self {
            entry: margin(entry, 0.0)?,
            other,
            early: early.transpose()?,
        })
    }
}

impl fmt::Display for Gate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", self.entry)?;
        if let Some(other) = self.other {
            write!(formatter, "/{other}")?;
        }
        if let Some([entry, other, relax, leave, caution]) = self.early {
            write!(formatter, "+{entry}/{other}/{relax}/{leave}/{caution}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_is_written_as_it_is_read() {
        for text in ["0", "1.5", "1/0.5", "0/-2", "1/0+0.5/1/2/0/8"] {
            assert_eq!(text.parse::<Gate>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "-1",
            "1/",
            "1/51",
            "nan",
            "1/nan",
            "1/2/3",
            "1+1/2/3/4",
            "1+1/2/-3/0/8",
        ] {
            assert!(text.parse::<Gate>().is_err(), "{text}");
        }
    }
}
