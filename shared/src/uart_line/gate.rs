//! The operating point on the line: margins of the confidence gate in place of the model's, in hundredths of a logit.
//!
//! ```text
//! entry = "0" ... "5000" | "-"         by how much the mean logit of a class has to exceed every other's
//! other = "-5000" ... "5000" | "-"     by how much that of movement outside the vocabulary
//! ```
//!
//! `-` is the margin of the model file.

use core::fmt;

use super::number;
use crate::stream::smoother::Gate;

/// Largest margin, in hundredths: that of the model file.
const MOST: u32 = 5000;

/// A command about the confidence gate.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum GateCommand {
    /// These margins, until the next start.
    Set(Gate),
    /// Change nothing.
    State,
}

impl GateCommand {
    /// Reads `state` or `set,entry,other`; none where it is neither.
    pub(super) fn parse(arguments: &str) -> Option<Self> {
        if arguments == "state" {
            return Some(Self::State);
        }
        gate(arguments.strip_prefix("set,")?).map(Self::Set)
    }
}

/// Reads `entry,other`; none where it is not written so.
pub(super) fn gate(text: &str) -> Option<Gate> {
    let (entry, other) = text.split_once(',')?;
    let [entry, other] = [margin(entry)?, margin(other)?];
    let is_valid = entry.is_none_or(|entry| entry >= 0);
    is_valid.then_some(Gate { entry, other })
}

/// A margin that is written as it would be; the outer none where it is not.
fn margin(text: &str) -> Option<Option<i16>> {
    if text == "-" {
        return Some(None);
    }
    let size = text.strip_prefix('-');
    let number = number(size.unwrap_or(text), "margin").ok()?;
    let is_written_so = number <= MOST && !(number == 0 && size.is_some());
    let number = i16::try_from(number).ok().filter(|_| is_written_so)?;
    Some(Some(if size.is_some() { -number } else { number }))
}

/// `entry,other`, as on the line.
pub(super) struct Margins(pub(super) Gate);

impl fmt::Display for Margins {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Gate { entry, other } = self.0;
        for (margin, after) in [(entry, ","), (other, "")] {
            match margin {
                Some(margin) => write!(formatter, "{margin}{after}")?,
                None => write!(formatter, "-{after}")?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::format;
    use proptest::prelude::*;

    #[test]
    fn other_numbers_and_spellings_are_none() {
        for wrong in [
            "", ",", "1", "5001,0", "-1,0", "0,5001", "0,-5001", "01,0", "1,-0", "+1,0", "1.5,0",
            "1,2,3", "99999,0", " 1,0", "1,--1", "1,",
        ] {
            assert_eq!(GateCommand::parse(&format!("set,{wrong}")), None, "{wrong}");
        }
        assert_eq!(GateCommand::parse("states"), None);
    }

    proptest! {
        #[test]
        fn margins_are_written_back(
            entry in proptest::option::of(0_i16..=5000), other in proptest::option::of(-5000_i16..=5000),
        ) {
            let gate = Gate { entry, other };
            let read = GateCommand::parse(&format!("set,{}", Margins(gate)));
            prop_assert_eq!(read, Some(GateCommand::Set(gate)));
        }
    }
}
