//! The UART line of an alignment: begun, a gesture found, the result.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = "ALIGN," sequence "," emitted "," state "," gestures "," turn "," mirrored ","
//!            distance "," margin
//! sequence = number            of the line, in one count with the others
//! emitted  = number            index of the newest sample received by then
//! state    = "waiting"         open the hand, with rest before and after
//!          | "aligned"         the electrodes are as `turn` and `mirrored` say from here on
//!          | "poor-distance"   nothing changed: the gestures look like no open hand
//!          | "poor-margin"     nothing changed: two placements look nearly as good; or, where these are on different
//!                              arms, samples were lost while the model decided
//!          | "timeout"         nothing changed: fewer than two gestures in 30 s
//!          | "cancelled"       nothing changed: on request
//!          | "disconnected"    the armband may have been taken off: as in training again, or as at the calibration in use
//!          | "unavailable"     the model has no template
//!          | "set"             `turn` and `mirrored` were given, or are those of the calibration in use
//! gestures = number            found so far
//! turn     = "0" ... "7"       places that the armband is turned by, as in force now
//! mirrored = "0" | "1"         whether the electrodes run the other way round, as in force now
//! distance = number | "-"      of the gestures from the template, hundredths of a nat; with a result alone
//! margin   = number | "-"      how much further the best other placement is, likewise
//! ```
//!
//! `number` and `checksum` are as in the other lines.
//!
//! ```text
//! $ALIGN,3,660,waiting,0,0,0,-,-*15
//! $ALIGN,97,2550,aligned,2,5,0,214,1130*2E
//! ```

use core::fmt::{self, Write as _};

use super::ParseError;
use super::fields::{Fields, Reader, Rows, Writer, field, rows, wrong};
use super::frame::framed;
use crate::names::names;
use crate::stream::alignment::{Alignment, Fit, NAT};
use crate::units::SampleIndex;

names! {
    /// State of an alignment.
    pub enum AlignmentState {
        /// Gestures are waited for.
        Waiting = "waiting",
        /// A placement was found and is in force.
        Aligned = "aligned",
        /// No placement looks like an open hand.
        PoorDistance = "poor-distance",
        /// Another placement looks nearly as good.
        PoorMargin = "poor-margin",
        /// Too few gestures in time.
        Timeout = "timeout",
        /// Ended on request.
        Cancelled = "cancelled",
        /// The alignment was dropped with the connection; that of the calibration in use is in force.
        Disconnected = "disconnected",
        /// The model has no template.
        Unavailable = "unavailable",
        /// An alignment was given from outside.
        Set = "set",
    }
}

/// Content of a line. `Display` writes the line, CR LF included: at most 77 bytes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct AlignmentReport {
    /// Number of the line, from 0; wraps.
    pub sequence: u32,
    /// The newest sample received when it was written.
    pub emitted: SampleIndex,
    /// State of the alignment.
    pub state: AlignmentState,
    /// Gestures found so far.
    pub gestures: u8,
    /// Alignment in force.
    pub alignment: Alignment,
    /// Distance and margin of the best placement ([`Fit::distance`], [`Fit::margin`]); with a result alone.
    pub quality: Option<(u32, u32)>,
}

impl AlignmentReport {
    /// Distance and margin of a fit, in hundredths of a nat.
    #[must_use]
    pub(crate) const fn quality_of(fit: Fit) -> (u32, u32) {
        (hundredths(fit.distance), hundredths(fit.margin))
    }

    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &[u8]) -> Result<Self, ParseError> {
        Self::of_body(framed(line)?)
    }
}

rows!(AlignmentReport {
    "ALIGN" (
        sequence: u32, emitted: SampleIndex, state: AlignmentState, gestures: u8, alignment: Alignment,
        quality: Option<(u32, u32)>
    ) => Self { sequence, emitted, state, gestures, alignment, quality },
});
field!(AlignmentState => Self: |text, state| text.write_str(state.name()), AlignmentState::from_name);

impl Fields<'_> for Alignment {
    type Value = Self;
    const COUNT: usize = 2;

    fn write(alignment: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        u8::write(&alignment.turn(), line)?;
        bool::write(&alignment.mirrored(), line)
    }

    fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
        let turn = u8::read(line, "turn")?;
        let mirrored = bool::read(line, "mirrored")?;
        let alignment = Self::new(turn, mirrored);
        if alignment.turn() == turn {
            Ok(alignment)
        } else {
            Err(wrong("turn"))
        }
    }
}

/// Codec of distance and margin.
impl Fields<'_> for (u32, u32) {
    type Value = Self;
    const COUNT: usize = 2;

    fn write((distance, margin): &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        u32::write(distance, line)?;
        u32::write(margin, line)
    }

    fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
        Ok((u32::read(line, "distance")?, u32::read(line, "margin")?))
    }
}

/// A distance in hundredths of a nat.
const fn hundredths(distance: u32) -> u32 {
    (distance as u64 * 100 / NAT as u64) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uart_line::tests::line as framed_line;
    use alloc::string::ToString;

    const WAITING: AlignmentReport = AlignmentReport {
        sequence: 3,
        emitted: SampleIndex(660),
        state: AlignmentState::Waiting,
        gestures: 0,
        alignment: Alignment::NONE,
        quality: None,
    };

    #[test]
    fn lines_are_those_of_the_documentation() {
        assert_eq!(WAITING.to_string(), "$ALIGN,3,660,waiting,0,0,0,-,-*15\r\n");
        let aligned = AlignmentReport {
            sequence: 97,
            emitted: SampleIndex(2550),
            state: AlignmentState::Aligned,
            gestures: 2,
            alignment: Alignment::new(5, false),
            quality: Some((214, 1130)),
        };
        assert_eq!(
            aligned.to_string(),
            "$ALIGN,97,2550,aligned,2,5,0,214,1130*2E\r\n"
        );
    }

    #[test]
    fn the_longest_line_has_77_bytes() {
        let longest = AlignmentReport {
            sequence: u32::MAX,
            emitted: SampleIndex(u32::MAX),
            state: AlignmentState::PoorDistance,
            gestures: u8::MAX,
            alignment: Alignment::new(7, true),
            quality: Some((u32::MAX, u32::MAX)),
        };
        assert_eq!(longest.to_string().len(), 77);
    }

    #[test]
    fn each_wrong_field_is_named() {
        let line = WAITING.to_string();
        let with = |from: &str, to: &str| {
            let body = line[1..line.len() - 5].replacen(from, to, 1);
            AlignmentReport::parse(framed_line(&body).as_bytes())
        };
        let field = |field| Err(ParseError::Field { field });
        assert_eq!(with("ALIGN", "LABEL"), field("kind"));
        assert_eq!(with(",3,", ",03,"), field("sequence"));
        assert_eq!(with("660", "x"), field("emitted"));
        assert_eq!(with("waiting", "wait"), field("state"));
        assert_eq!(with("waiting,0", "waiting,256"), field("gestures"));
        assert_eq!(with("0,0,0", "0,8,0"), field("turn"));
        assert_eq!(with("0,0,0", "0,0,2"), field("mirrored"));
        assert_eq!(with("-,-", "-,1"), field("distance"));
        assert_eq!(with("-,-", "1,-"), field("margin"));
        let found = with("-,-", "-");
        assert_eq!(
            found,
            Err(ParseError::Fields {
                expected: 9,
                found: 8
            })
        );
    }
}
