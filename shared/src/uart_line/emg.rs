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
use super::frame::hexadecimals;
use crate::units::{Sample, SampleIndex};

/// Content of a line. `Display` writes the line, CR LF included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct EmgReport {
    /// Index of the older sample.
    pub first: SampleIndex,
    /// Both samples, the older first.
    pub samples: [Sample; 2],
}

rows!(EmgReport {
    "EMG" (first: SampleIndex, older: Sample, newer: Sample) => Self { first, samples: [older, newer] },
});

field!(Sample => Sample: |text, sample| {
    let mut channels = sample.iter();
    channels.try_for_each(|channel| write!(text, "{:02X}", channel.cast_unsigned()))
}, |text| hexadecimals(text, 2).map(|channels| channels.map(|channel| channel as i8)));
