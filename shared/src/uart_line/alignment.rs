//! The UART line of an alignment: begun, a gesture found, the result.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = "ALIGN," sequence "," emitted "," state "," gestures "," turn "," mirrored ","
//!            distance "," margin
//! sequence = number            of the line, in one count with the others
//! emitted  = number            index of the newest sample received by then
//! state    = of `AlignmentState`
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
use super::fields::{Fields, Reader, Rows, Writer, field, fields, rows, wrong};
use crate::names::names;
use crate::stream::alignment::{Alignment, Fit, NAT};
use crate::units::SampleIndex;

names! {
    /// State of an alignment.
    pub enum AlignmentState {
        /// Gestures are waited for: open the hand, with rest before and after.
        Waiting = "waiting",
        /// The alignment that was found is in force from here on.
        Aligned = "aligned",
        /// Nothing changed: the gestures look like no open hand.
        PoorDistance = "poor-distance",
        /// Nothing changed: two placements look nearly as good; or, where these are on different arms, samples were lost while
        /// the model decided.
        PoorMargin = "poor-margin",
        /// Nothing changed: fewer than two gestures in 30 s.
        Timeout = "timeout",
        /// Nothing changed: ended on request.
        Cancelled = "cancelled",
        /// The alignment is dropped, for the armband may have been taken off: as in training again, or as at the calibration in use.
        Disconnected = "disconnected",
        /// The model has no template.
        Unavailable = "unavailable",
        /// The alignment in force was given, or is that of the calibration in use.
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
    /// Quality of the best placement; with a result alone.
    pub quality: Option<Quality>,
}

/// Nearness of the best placement to the template, in hundredths of a nat.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Quality {
    /// [`Fit::distance`].
    pub distance: u32,
    /// [`Fit::margin`].
    pub margin: u32,
}

impl From<Fit> for Quality {
    fn from(fit: Fit) -> Self {
        let hundredths = |distance: u32| (u64::from(distance) * 100 / u64::from(NAT)) as u32;
        Self {
            distance: hundredths(fit.distance),
            margin: hundredths(fit.margin),
        }
    }
}

rows!(AlignmentReport {
    "ALIGN" (
        sequence: u32, emitted: SampleIndex, state: AlignmentState, gestures: u8, alignment: Alignment,
        quality: Option<Quality>
    ) => Self { sequence, emitted, state, gestures, alignment, quality },
});
fields!(Quality {
    distance: u32,
    margin: u32
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
