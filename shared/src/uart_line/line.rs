//! Lines of any kind, and a reader that finds them among received bytes: the PC's side of the UART.

use core::fmt;

use super::alignment::AlignmentReport;
use super::answer::Answer;
use super::calibration::CalibrationReport;
use super::emg::EmgReport;
use super::fields::first;
use super::frame::framed;
use super::imu::ImuReport;
use super::{ParseError, Report};

/// Most bytes of a line, CR LF included.
pub const MAX_LINE_BYTES: usize = 256;

/// A line of any kind. `Display` writes it, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Line<'a> {
    /// A label or a change of state.
    Report(Report),
    /// Progress or result of an alignment.
    Alignment(AlignmentReport),
    /// Progress or result of a calibration, as it is written; it is read as a comment.
    Calibration(CalibrationReport),
    /// Two samples.
    Emg(EmgReport),
    /// Movement of the armband.
    Imu(ImuReport),
    /// The answer to a command.
    Answer(Answer<'a>),
    /// Text for people: the characters after `#`, without the line end.
    Comment(&'a str),
}

impl<'a> Line<'a> {
    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field; a comment of other characters
    /// than printable ASCII has a wrong frame.
    pub fn parse(line: &'a [u8]) -> Result<Self, ParseError> {
        if let [b'#', comment @ .., b'\r', b'\n'] = line {
            let is_text = |byte: &u8| byte.is_ascii_graphic() || *byte == b' ';
            return core::str::from_utf8(comment)
                .ok()
                .filter(|_| comment.iter().all(is_text))
                .map(Self::Comment)
                .ok_or(ParseError::Frame);
        }
        let body = framed(line)?;
        match first(body) {
            "LABEL" | "STATE" => Report::of_body(body).map(Self::Report),
            "ALIGN" => AlignmentReport::of_body(body).map(Self::Alignment),
            "EMG" => EmgReport::of_body(body).map(Self::Emg),
            "IMU" => ImuReport::of_body(body).map(Self::Imu),
            "OK" | "ERR" => Answer::of_body(body).map(Self::Answer),
            _ => Err(ParseError::Field { field: "kind" }),
        }
    }
}

impl fmt::Display for Line<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Report(report) => report.fmt(formatter),
            Self::Alignment(report) => report.fmt(formatter),
            Self::Calibration(report) => report.fmt(formatter),
            Self::Emg(report) => report.fmt(formatter),
            Self::Imu(report) => report.fmt(formatter),
            Self::Answer(answer) => answer.fmt(formatter),
            Self::Comment(text) => write!(formatter, "#{text}\r\n"),
        }
    }
}

/// Finds the lines of a device among received bytes, wherever reception begins or bytes are lost.
///
/// Takes any bytes; each costs bounded work, and nothing is kept of a line that is too long. A `$` begins a line anew, but
/// for one inside a comment, which may quote a command; a line behind a comment that was cut is found nevertheless.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LineReader {
    line: [u8; MAX_LINE_BYTES],
    /// Bytes of `line` so far.
    length: usize,
    /// The newest line has been given, and is dropped with the next byte.
    is_done: bool,
    /// The line is too long, or began before the reader did: bytes are dropped up to its end.
    is_lost: bool,
}

impl Default for LineReader {
    /// A reader before the first byte, which need not begin a line.
    fn default() -> Self {
        Self {
            line: [0; MAX_LINE_BYTES],
            length: 0,
            is_done: false,
            is_lost: false,
        }
    }
}

impl LineReader {
    /// Takes a byte; if it ends a line, gives the line or why it is damaged.
    pub fn push(&mut self, byte: u8) -> Option<Result<Line<'_>, ParseError>> {
        if self.is_done {
            *self = Self {
                line: self.line,
                ..Self::default()
            };
        }
        if byte == b'$' && !(self.line[..self.length].starts_with(b"#")) {
            self.length = 0;
            self.is_lost = false;
        }
        if self.length == MAX_LINE_BYTES {
            self.length = 0;
            self.is_lost = true;
        }
        if self.is_lost {
            self.is_done = byte == b'\n';
            return self.is_done.then_some(Err(ParseError::Frame));
        }
        let free = self.line.get_mut(self.length)?;
        *free = byte;
        self.length += 1;
        if byte != b'\n' {
            return None;
        }
        self.is_done = true;
        let line = &self.line[..self.length];
        // A comment without its end, and the line behind it.
        let inner = line.iter().rposition(|&byte| byte == b'$').unwrap_or(0);
        if inner > 0
            && let Ok(found) = Line::parse(&line[inner..])
        {
            return Some(Ok(found));
        }
        Some(Line::parse(line))
    }

    /// Bytes were lost, or the connection is a new one: what has come of a line is dropped.
    pub const fn interrupt(&mut self) {
        self.length = 0;
        self.is_done = false;
        self.is_lost = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{
        format,
        string::{String, ToString},
        vec::Vec,
    };

    const STATE: &str = "$STATE,0,0,0,relax,0,boot,0,0,0*3F\r\n";
    const LABEL: &str = "$LABEL,2,609,660,close,1,-,0,0,0*0D\r\n";
    /// A comment that quotes a command.
    const COMMENT: &str =
        "# follows no armband: none is bound. Wear yours, or send $BIND,begin*4A\r\n";

    /// Each line written again, or `!` in place of a damaged one.
    fn read(bytes: &[u8]) -> Vec<String> {
        let mut reader = LineReader::default();
        let mut lines = Vec::new();
        for &byte in bytes {
            if let Some(found) = reader.push(byte) {
                lines.push(found.map_or("!".into(), |line| line.to_string()));
            }
        }
        lines
    }

    #[test]
    fn a_line_after_a_cut_is_read() {
        // Of a framed line, of a comment, and of one that reception began in.
        for (bytes, lines) in [
            (format!("{}{LABEL}", &STATE[..20]), &[LABEL][..]),
            (format!("{}{LABEL}", &COMMENT[..9]), &[LABEL]),
            (format!("{}{LABEL}", &STATE[5..]), &["!", LABEL]),
            (
                format!("\0\u{ff}#$\n{COMMENT}{STATE}"),
                &["!", COMMENT, STATE],
            ),
        ] {
            assert_eq!(read(bytes.as_bytes()), lines, "{bytes}");
        }
    }

    #[test]
    fn a_line_of_256_bytes_is_read_and_a_longer_one_refused_once() {
        let comment = |length: usize| format!("#{}\r\n", "x".repeat(length - 3));
        let longest = comment(MAX_LINE_BYTES);
        assert_eq!(read(longest.as_bytes()), [longest.as_str()]);
        for length in [MAX_LINE_BYTES + 1, 10_000] {
            let bytes = comment(length) + LABEL;
            assert_eq!(read(bytes.as_bytes()), ["!", LABEL], "{length}");
        }
    }

    #[test]
    fn after_an_interruption_nothing_is_left_of_a_line() {
        let mut reader = LineReader::default();
        for &byte in COMMENT.as_bytes().iter().take(10) {
            assert_eq!(reader.push(byte), None);
        }
        reader.interrupt();
        let LineReader { line, .. } = reader;
        let fresh = LineReader::default();
        assert_eq!(reader, LineReader { line, ..fresh });
    }
}
