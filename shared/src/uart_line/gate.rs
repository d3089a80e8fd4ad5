//! The operating point on the line, in place of the model's: margins in hundredths of a logit, and a reaction.
//!
//! ```text
//! entry = "0" ... "5000" | "-"         by how much the mean logit of a class has to exceed every other's
//! other = "-5000" ... "5000" | "-"     by how much that of movement outside the vocabulary
//! reaction = "fast" | "balanced" | "steady" | "late" | "-"     all margins at once, but for those that are given
//! ```
//!
//! `-` is as in the model file.

use core::fmt::{self, Write as _};

use super::ParseError;
use super::fields::{Fields, Reader, Writer, field, fields};
use super::frame::number;
use crate::stream::smoother::{Gate, Reaction};

/// Largest margin, in hundredths: the model file's.
const MOST: u32 = 5000;

/// A command about the confidence gate.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum GateCommand {
    /// This operating point, until the next start.
    Set(Gate),
    /// Change nothing.
    State,
}

fields!(Gate { entry: Option<Entry>, other: Option<Margin>, reaction: Option<Reaction> });

field!(Reaction => Self: |text, reaction| text.write_str(reaction.name()), Self::from_name);

/// Codec of a margin from 0 on.
struct Entry;
field!(Entry => i16: |text, entry| write!(text, "{entry}"), |text| margin(text).filter(|entry| *entry >= 0));

/// Codec of a margin.
struct Margin;
field!(Margin => i16: |text, margin| write!(text, "{margin}"), margin);

/// A margin that is written as it would be.
fn margin(text: &str) -> Option<i16> {
    let size = text.strip_prefix('-');
    let number = number(size.unwrap_or(text))?;
    let is_written_so = number <= MOST && !(number == 0 && size.is_some());
    let number = i16::try_from(number).ok().filter(|_| is_written_so)?;
    Some(if size.is_some() { -number } else { number })
}
