//! Format of the UART output: one ASCII line per emitted label and per change of state.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = kind "," sequence "," instant "," emitted "," label "," valid "," cause ","
//!            lost "," bridged "," resets [ "," strength ]
//! kind     = "LABEL" | "STATE"      a label was emitted | the state changed
//! sequence = number                 of the line, from 0; a jump means that lines were lost
//! instant  = number                 reference time: index of the sample that the label refers to
//! emitted  = number                 index of the newest sample received by then
//! label    = "relax" | "open" | "close" | "wave-in" | "wave-out" | "pinch"
//! valid    = "1" | "0"              level of the `valid` pin; with 0 the label is relax
//! cause    = "-" with valid 1, else "boot" | "watchdog" | "stack" | "model-refused" | "disconnected"
//!            | "silence" | "gap" | "losses" | "stalled" | "installation" | "locked"
//!                                cause of the safe state
//! lost     = number                 samples lost since the start
//! bridged  = number                 lost samples that were filled in since the start
//! resets   = number                 resets of the window since the start
//! strength = "0" ... "100"          percent of the wearer's range, 0 with valid 0; after the command STRENGTH,on
//! number   = 0 ... 4294967295, decimal, no leading zeros
//! checksum = two upper-case hexadecimal digits: all bytes of the body, XORed (as NMEA 0183 does)
//! ```
//!
//! A line has at most 103 bytes, CR LF included. The delay of a label is `emitted - instant` samples of
//! 5 ms. Every line that parses is written back byte for byte.
//!
//! While an alignment is made there are other lines between these: [`alignment`]. On the same line the device takes
//! commands, [`command`], and answers each, [`answer`]; two of them ask for the samples themselves, [`emg`], and for the armband's movement, [`imu`]. Without commands
//! it writes none of these. A program that reads a device finds lines of every kind with [`mod@line`].
//!
//! ```text
//! $STATE,0,0,0,relax,0,boot,0,0,0*3F
//! $LABEL,2,609,660,close,1,-,0,0,0*0D
//! $LABEL,2,609,660,close,1,-,0,0,0,64*23
//! ```

pub mod alignment;
pub mod answer;
pub mod calibration;
pub mod command;
pub mod emg;
mod fields;
mod frame;
pub mod gate;
mod hid;
pub mod imu;
pub mod install;
pub mod line;
pub mod lock;
mod refusal;

use core::fmt::{self, Write as _};

use fields::{Fields, Reader, Rows, Writer, field, fields, rows, wrong};
use frame::{framed, number};

use crate::intent::Intent;
use crate::stream::safe_state::{Cause, Status};
use crate::stream::strength::Percent;
use crate::units::SampleIndex;

/// USB numbers, vendor and product, of a board that has its serial port there.
///
/// The test number of pid.codes, for a developer's own boards alone. A board that is given to others, sold or not, needs a number
/// of its own: docs/guides/port.md. Hosts choose their driver by the class, so any number works; `myointent flash` finds a board by it.
pub const USB_NUMBERS: [u16; 2] = [0x1209, 0x0001];

/// Why a line is written.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ReportKind {
    /// A label of the smoother.
    Label,
    /// The state became valid, became safe, or is safe for another cause.
    State,
}

/// Losses since the start. Each count stays at its maximum.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Counters {
    /// Samples lost.
    pub lost: u32,
    /// Lost samples that were filled in.
    pub bridged: u32,
    /// Resets of the window.
    pub resets: u32,
}

/// Content of a line. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Report {
    /// Kind of the report.
    pub kind: ReportKind,
    /// Number of the line, from 0; wraps.
    pub sequence: u32,
    /// Reference time: the sample that the label refers to.
    pub instant: SampleIndex,
    /// The newest sample received when it was written.
    pub emitted: SampleIndex,
    /// Label, `valid` and cause.
    pub status: Status,
    /// Losses so far.
    pub counters: Counters,
    /// Strength in percent of the wearer's range, 0 while not valid; none if the line does not have it.
    pub strength: Option<Percent>,
}

rows!(Report {
    "LABEL" (sequence: u32, instant: SampleIndex, emitted: SampleIndex, status: Status, counters: Counters)
        => Self { kind: ReportKind::Label, sequence, instant, emitted, status, counters, strength: None },
    "STATE" (sequence: u32, instant: SampleIndex, emitted: SampleIndex, status: Status, counters: Counters)
        => Self { kind: ReportKind::State, sequence, instant, emitted, status, counters, strength: None },
    "LABEL" (
        sequence: u32, instant: SampleIndex, emitted: SampleIndex, status: Status, counters: Counters, strength: Percent
    ) => Self { kind: ReportKind::Label, sequence, instant, emitted, status, counters, strength: Some(strength) },
    "STATE" (
        sequence: u32, instant: SampleIndex, emitted: SampleIndex, status: Status, counters: Counters, strength: Percent
    ) => Self { kind: ReportKind::State, sequence, instant, emitted, status, counters, strength: Some(strength) },
});
fields!(Counters {
    lost: u32,
    bridged: u32,
    resets: u32
});
field!(Intent => Intent: |text, intent| text.write_str(intent.name()), Intent::from_name);
field!(Percent => Self: |text, percent| write!(text, "{}", u32::from(percent.get())), |text| {
    Self::new(number(text)?.try_into().ok()?)
});
field!(Cause => Cause: |text, cause| text.write_str(cause.name()), Cause::from_name);

impl Fields<'_> for Status {
    type Value = Self;
    const COUNT: usize = 3;

    fn write(status: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        Intent::write(&status.label(), line)?;
        bool::write(&status.valid(), line)?;
        Option::<Cause>::write(&status.cause(), line)
    }

    fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
        let label = Intent::read(line, "label")?;
        let valid = bool::read(line, "valid")?;
        let cause = Option::<Cause>::read(line, "cause")?;
        match (valid, cause) {
            (true, None) => Ok(Self::Valid(label)),
            (false, Some(_)) if label != Intent::Relax => Err(wrong("label")),
            (false, Some(cause)) => Ok(Self::Safe(cause)),
            (true, Some(_)) | (false, None) => Err(wrong("cause")),
        }
    }
}

/// Why bytes are not a line.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum ParseError {
    #[error("not framed as `$...*HH` CR LF in ASCII: drop the line and wait for the next `$`")]
    Frame,
    #[error("checksum {expected:02X} expected, {found:02X} found: drop the line")]
    Checksum { expected: u8, found: u8 },
    #[error("{expected} fields expected, {found} found: is the sender of another version?")]
    Fields { expected: usize, found: usize },
    #[error("field `{field}` holds no value it may hold: is the sender of another version?")]
    Field { field: &'static str },
}

impl Report {
    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &[u8]) -> Result<Self, ParseError> {
        Self::of_body(framed(line)?)
    }

    /// The report as it is written before the command `STRENGTH,on`.
    #[must_use]
    pub const fn without_strength(self) -> Self {
        Self {
            strength: None,
            ..self
        }
    }
}

/// Reads a flag: 0 or 1.
#[must_use]
pub fn flag(text: &str) -> Option<bool> {
    match text {
        "0" => Some(false),
        "1" => Some(true),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
