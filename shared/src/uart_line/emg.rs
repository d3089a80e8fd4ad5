//! The UART line of the raw stream: the two samples of a notification, as the armband sent them.
//!
//! ```text
//! line   = "$" body "*" checksum CR LF
//! body   = "EMG," first "," sample "," sample      the older sample first
//! first  = number                 index of the older sample, in one count with the labels' lines
//! sample = 16 hexadecimal digits  channels 1 to 8, a byte of two's complement each, upper case
//! ```
//!
//! `number` and `checksum` are as in the other lines. Written only after the command `RAW,on`, without a line number: a
//! jump of `first` by more than 2 means that samples were lost on the way, or lines dropped for want of time. A line has
//! at most 54 bytes; 100 of them a second are half of what 115200 baud carry.
//!
//! ```text
//! $EMG,1200,0001FF7F80050607,08090A0B0C0D0E0F*1A
//! ```

use core::fmt::{self, Write as _};

use super::ParseError;
use super::fields::{Fields, Reader, Rows, Writer, field, rows};
use super::frame::{framed, hexadecimal};
use crate::units::{Sample, SampleIndex};

/// Content of a line. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct EmgReport {
    /// Index of the older sample.
    pub first: SampleIndex,
    /// Both samples, the older first.
    pub samples: [Sample; 2],
}

impl EmgReport {
    /// Reads one line, CR LF included.
    ///
    /// # Errors
    /// A wrong frame, a wrong checksum, a wrong number of fields, or the first wrong field.
    pub fn parse(line: &[u8]) -> Result<Self, ParseError> {
        Self::of_body(framed(line)?)
    }
}

rows!(EmgReport {
    "EMG" (first: SampleIndex, older: Sample, newer: Sample) => Self { first, samples: [older, newer] },
});

field!(Sample => Sample: |text, sample| {
    let mut channels = sample.iter();
    channels.try_for_each(|channel| write!(text, "{:02X}", channel.cast_unsigned()))
}, sample);

fn sample(text: &str) -> Option<Sample> {
    let (digits, rest) = text.as_bytes().as_chunks::<2>();
    let mut sample = Sample::default();
    if digits.len() != sample.len() || !rest.is_empty() {
        return None;
    }
    for (channel, digits) in sample.iter_mut().zip(digits) {
        *channel = hexadecimal(digits, 2, b'A')? as i8;
    }
    Some(sample)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uart_line::tests::line as framed_line;
    use alloc::string::ToString;

    const REPORT: EmgReport = EmgReport {
        first: SampleIndex(1200),
        samples: [
            [0, 1, -1, 127, -128, 5, 6, 7],
            [8, 9, 10, 11, 12, 13, 14, 15],
        ],
    };

    #[test]
    fn the_line_is_that_of_the_documentation() {
        let line = "$EMG,1200,0001FF7F80050607,08090A0B0C0D0E0F*1A\r\n";
        assert_eq!(REPORT.to_string(), line);
    }

    #[test]
    fn the_longest_line_has_54_bytes() {
        let first = SampleIndex(u32::MAX);
        assert_eq!(EmgReport { first, ..REPORT }.to_string().len(), 54);
    }

    #[test]
    fn each_wrong_field_is_named() {
        let line = REPORT.to_string();
        let with = |from: &str, to: &str| {
            let body = line[1..line.len() - 5].replacen(from, to, 1);
            EmgReport::parse(framed_line(&body).as_bytes())
        };
        let field = |field| Err(ParseError::Field { field });
        assert_eq!(with("EMG", "LABEL"), field("kind"));
        assert_eq!(with("1200", "01200"), field("first"));
        assert_eq!(with("0001", "001"), field("older"));
        assert_eq!(with("0001", "00010"), field("older"));
        assert_eq!(with("0001", "000x"), field("older"));
        assert_eq!(with("0E0F", "0e0F"), field("newer"));
        let fields = Err(ParseError::Fields {
            expected: 4,
            found: 3,
        });
        assert_eq!(with(",0001", ""), fields);
    }
}
