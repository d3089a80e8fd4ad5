//! Format of the UART output: one ASCII line per emitted label and per change of state.
//!
//! ```text
//! line     = "$" body "*" checksum CR LF
//! body     = kind "," sequence "," instant "," emitted "," label "," valid "," cause ","
//!            lost "," bridged "," resets
//! kind     = "LABEL" | "STATE"      a label was emitted | the state changed
//! sequence = number                 of the line, from 0; a jump means that lines were lost
//! instant  = number                 reference time: index of the sample that the label refers to
//! emitted  = number                 index of the newest sample received by then
//! label    = "relax" | "open" | "close" | "wave-in" | "wave-out" | "pinch"
//! valid    = "1" | "0"              level of the `valid` pin; with 0 the label is relax
//! cause    = "-" with valid 1, else "boot" | "watchdog" | "stack" | "model-refused" | "disconnected"
//!            | "silence" | "gap" | "losses" | "stalled" | "installation"      cause of the safe state
//! lost     = number                 samples lost since the start
//! bridged  = number                 lost samples that were filled in since the start
//! resets   = number                 resets of the window since the start
//! number   = 0 ... 4294967295, decimal, no leading zeros
//! checksum = two upper-case hexadecimal digits: all bytes of the body, XORed (as NMEA 0183 does)
//! ```
//!
//! A line has at most 99 bytes, CR LF included. The delay of a label is `emitted - instant` samples of
//! 5 ms. Every line that parses is written back byte for byte.
//!
//! While an alignment is made there are other lines between these: [`alignment`]. On the same line the device takes
//! commands, [`command`], and answers each, [`answer`]; one of them asks for the samples themselves, [`emg`]. Who sends none sees
//! none of these. A program that reads a device finds lines of every kind with [`mod@line`].
//!
//! ```text
//! $STATE,0,0,0,relax,0,boot,0,0,0*3F
//! $LABEL,2,609,660,close,1,-,0,0,0*0D
//! ```

pub mod alignment;
pub mod answer;
pub mod command;
pub mod emg;
pub mod gate;
pub mod install;
pub mod line;
mod refusal;

use core::fmt::{self, Write};

use crate::intent::Intent;
use crate::stream::safe_state::{Cause, Status};
use crate::units::SampleIndex;

/// Why a line is written.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Kind {
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
    /// What it reports.
    pub kind: Kind,
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
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            Kind::Label => "LABEL",
            Kind::State => "STATE",
        };
        let Counters {
            lost,
            bridged,
            resets,
        } = self.counters;
        write_framed(
            formatter,
            format_args!(
                "{kind},{},{},{},{},{},{},{lost},{bridged},{resets}",
                self.sequence,
                self.instant.0,
                self.emitted.0,
                self.status.label().name(),
                u8::from(self.status.valid()),
                self.status.cause().map_or("-", Cause::name),
            ),
        )
    }
}

/// Writes `$`, the body, `*` and its checksum, CR LF.
fn write_framed(formatter: &mut fmt::Formatter<'_>, text: fmt::Arguments<'_>) -> fmt::Result {
    formatter.write_char('$')?;
    let mut body = Summed {
        inner: &mut *formatter,
        sum: 0,
    };
    body.write_fmt(text)?;
    let sum = body.sum;
    write!(formatter, "*{sum:02X}\r\n")
}

/// Writes text and computes the XOR of its bytes.
struct Summed<'a, W> {
    inner: &'a mut W,
    sum: u8,
}

impl<W: Write> Write for Summed<'_, W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.sum ^= checksum(text);
        self.inner.write_str(text)
    }
}

fn checksum(body: &str) -> u8 {
    body.bytes().fold(0, |sum, byte| sum ^ byte)
}

/// Why bytes are not a line.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, thiserror::Error)]
pub enum ParseError {
    /// Not `$ ... *HH` CR LF in ASCII.
    #[error("not framed as `$...*HH` CR LF in ASCII: drop the line and wait for the next `$`")]
    Frame,
    /// The body is damaged.
    #[error("checksum {expected:02X} expected, {found:02X} found: drop the line")]
    Checksum {
        /// Of the body as it came.
        expected: u8,
        /// As written in the line.
        found: u8,
    },
    /// Too few or too many fields.
    #[error("{expected} fields expected, {found} found: is the sender of another version?")]
    Fields {
        /// Fields of a line.
        expected: usize,
        /// Fields found.
        found: usize,
    },
    /// A field has a value that the grammar does not allow.
    #[error("field `{field}` holds no value it may hold: is the sender of another version?")]
    Field {
        /// Its name in the grammar.
        field: &'static str,
    },
}

impl Report {
    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &[u8]) -> Result<Self, ParseError> {
        let [
            kind,
            sequence,
            instant,
            emitted,
            label,
            valid,
            cause,
            lost,
            bridged,
            resets,
        ] = fields(framed(line)?)?;
        Ok(Self {
            kind: match kind {
                "LABEL" => Kind::Label,
                "STATE" => Kind::State,
                _ => return Err(ParseError::Field { field: "kind" }),
            },
            sequence: number(sequence, "sequence")?,
            instant: SampleIndex(number(instant, "instant")?),
            emitted: SampleIndex(number(emitted, "emitted")?),
            status: status(label, valid, cause)?,
            counters: Counters {
                lost: number(lost, "lost")?,
                bridged: number(bridged, "bridged")?,
                resets: number(resets, "resets")?,
            },
        })
    }
}

/// The fields of a body, as many as are expected.
fn fields<const COUNT: usize>(body: &str) -> Result<[&str; COUNT], ParseError> {
    let mut fields = [""; COUNT];
    let found = body.split(',').count();
    if found != COUNT {
        return Err(ParseError::Fields {
            expected: COUNT,
            found,
        });
    }
    for (field, text) in fields.iter_mut().zip(body.split(',')) {
        *field = text;
    }
    Ok(fields)
}

/// The body of a line whose frame and checksum are right, CR LF included.
fn framed(line: &[u8]) -> Result<&str, ParseError> {
    unframed(line.strip_suffix(b"\r\n").ok_or(ParseError::Frame)?)
}

/// The same without CR LF.
fn unframed(line: &[u8]) -> Result<&str, ParseError> {
    let (body, found) = core::str::from_utf8(line)
        .ok()
        .filter(|text| text.is_ascii())
        .and_then(|text| text.strip_prefix('$')?.rsplit_once('*'))
        .ok_or(ParseError::Frame)?;
    let found = hexadecimal(found).ok_or(ParseError::Frame)?;
    let expected = checksum(body);
    if found == expected {
        Ok(body)
    } else {
        Err(ParseError::Checksum { expected, found })
    }
}

/// Two upper-case hexadecimal digits.
fn hexadecimal(text: &str) -> Option<u8> {
    let is_digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'A'..=b'F');
    if text.len() != 2 || !text.bytes().all(is_digit) {
        return None;
    }
    u8::from_str_radix(text, 16).ok()
}

fn number(text: &str, field: &'static str) -> Result<u32, ParseError> {
    let canonical =
        text.bytes().all(|byte| byte.is_ascii_digit()) && (text == "0" || !text.starts_with('0'));
    text.parse()
        .ok()
        .filter(|_| canonical)
        .ok_or(ParseError::Field { field })
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

fn status(label: &str, valid: &str, cause: &str) -> Result<Status, ParseError> {
    let wrong = |field| ParseError::Field { field };
    let label = Intent::from_name(label).ok_or(wrong("label"))?;
    match valid {
        "1" if cause == "-" => Ok(Status::Valid(label)),
        "1" => Err(wrong("cause")),
        "0" if label != Intent::Relax => Err(wrong("label")),
        "0" => Cause::from_name(cause)
            .map(Status::Safe)
            .ok_or(wrong("cause")),
        _ => Err(wrong("valid")),
    }
}

#[cfg(test)]
mod tests;
