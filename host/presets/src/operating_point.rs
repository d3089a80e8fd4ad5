//! Operating point of the smoother, as a person writes it.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use shared::stream::smoother::{Early, Margins, Reaction};
use shared::units::MAX_ENTRY_MARGIN;

/// Operating point: a reaction, margins of its own, or both, as in `balanced,other=0,caution=4` or `entry=1`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct OperatingPoint {
    reaction: Option<Reaction>,
    entry: Option<f32>,
    pub(crate) other: Option<f32>,
    caution: Option<f32>,
}

impl OperatingPoint {
    /// The margins. Without a reaction every label waits for its look-ahead, and a margin that is not given is 0.
    pub fn margins(self, knows_other: bool) -> Margins {
        let base = self.reaction.map_or(Margins::NONE, Reaction::margins);
        let other = self.other.or(base.other).unwrap_or(0.0);
        Margins {
            entry: self.entry.unwrap_or(base.entry),
            other: knows_other.then_some(other),
            early: base.early.map(|early| Early {
                caution: self.caution.unwrap_or(early.caution),
                ..early
            }),
        }
    }
}

impl FromStr for OperatingPoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut point = Self::default();
        for word in text.split(',') {
            let Some((name, value)) = word.split_once('=') else {
                let names = || Reaction::ALL.map(Reaction::name).join(", ");
                let found = Reaction::from_name(word);
                let found = found.ok_or_else(|| format!("`{word}`: expected {}", names()))?;
                if point.reaction.replace(found).is_some() {
                    return Err(format!("`{word}`: expected one reaction"));
                }
                continue;
            };
            let (place, least) = match name {
                "entry" => (&mut point.entry, 0.0),
                "other" => (&mut point.other, -MAX_ENTRY_MARGIN),
                "caution" => (&mut point.caution, 0.0),
                _ => return Err(format!("`{name}`: expected entry, other or caution")),
            };
            let margin = value.parse().ok();
            let margin = margin.filter(|margin| (least..=MAX_ENTRY_MARGIN).contains(margin));
            let wrong = || format!("`{word}`: expected {least} to {MAX_ENTRY_MARGIN}");
            if place.replace(margin.ok_or_else(wrong)?).is_some() {
                return Err(format!("`{name}`: expected once"));
            }
        }
        if point.caution.is_some() && point.reaction.is_none() {
            return Err("caution: expected a reaction beside it".to_owned());
        }
        Ok(point)
    }
}

impl TryFrom<String> for OperatingPoint {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<OperatingPoint> for String {
    fn from(point: OperatingPoint) -> Self {
        point.to_string()
    }
}

impl fmt::Display for OperatingPoint {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let margins = [
            ("entry", self.entry),
            ("other", self.other),
            ("caution", self.caution),
        ];
        let margins = margins
            .into_iter()
            .filter_map(|(name, margin)| Some(format!("{name}={}", margin?)));
        let reaction = self.reaction.map(|reaction| reaction.name().to_owned());
        let words: Vec<String> = reaction.into_iter().chain(margins).collect();
        formatter.write_str(&words.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_operating_point_is_written_as_it_is_read() {
        for text in "late entry=0 entry=1.5,other=-2 balanced,other=0,caution=4".split(' ') {
            assert_eq!(text.parse::<OperatingPoint>().unwrap().to_string(), text);
        }
        // Words, values and their combinations; the last one is empty.
        let wrong = "slow 1.5 relax=1 entry= entry=-1 entry=51 entry=nan other=-51 caution=8 \
                     fast, fast,steady fast,caution=-1 entry=1,entry=2 ";
        for text in wrong.split(' ') {
            assert!(text.parse::<OperatingPoint>().is_err(), "{text}");
        }
    }
}
