//! Line of a journal: `5f3a0c11 17 {"is":"cue",...}`, a CRC-32 of what follows, the line's number from 0 on, and JSON.
//! Format 2 had no movement.

use std::fmt::Write as _;

use crc::{CRC_32_ISO_HDLC, Crc};
use recordings::labels::motion::Motion;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, Sample, SampleIndex};

use crate::record::session::{Output, RejectReason};

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Version of the format described here.
pub const FORMAT: u32 = 3;
/// Oldest version that can be read.
pub const OLDEST_FORMAT: u32 = 2;
/// Beginning of the JSON of each line.
const JSON: &[u8] = b"{\"is\":\"";

/// Description of a session.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct Header {
    /// Version of the journal's format.
    pub format: u32,
    /// Version of the program.
    pub version: String,
    /// Time of the beginning, UTC.
    pub began: String,
    /// Name of the person.
    pub person: String,
    /// Name of the protocol.
    pub protocol: String,
    /// Motions of the protocol.
    pub classes: Vec<String>,
    /// Whether the session is free: the person names the gestures.
    pub free: bool,
    /// Source of the samples.
    pub source: String,
    /// Whether the samples are synthetic.
    pub synthetic: bool,
}

impl Header {
    /// Whether the journal has a format that this program reads.
    pub fn is_read(&self) -> bool {
        (OLDEST_FORMAT..=FORMAT).contains(&self.format)
    }
}

/// Entry of a journal.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(tag = "is", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Entry {
    /// Header, the first line.
    Begin(Header),
    /// Consecutive samples, 16 hexadecimal digits each.
    Samples {
        /// Index of the first sample.
        first: u32,
        /// Samples as hexadecimal digits.
        emg: String,
    },
    /// Movement of the armband, with the index of the sample that was due.
    Imu {
        /// Index and movement.
        rows: Vec<(u32, [i16; 10])>,
    },
    /// Placement of the armband from the next sample on, as the board was aligned.
    Placement {
        /// Number of places that the armband is turned by.
        turn: u8,
        /// Whether the armband is on the other arm.
        mirrored: bool,
    },
    /// Break: the next samples do not continue those before.
    Break,
    /// Beginning of a round.
    Round {
        /// Number of the round, from 1.
        number: u32,
        /// Index of the first sample of the round.
        at: u32,
    },
    /// Cue from a sample on.
    Cue {
        /// Index of the first sample of the cue.
        at: u32,
        /// Name of the motion; none for no cue.
        cue: Option<String>,
        /// Number of the attempt.
        trial: u32,
    },
    /// Rejection of a trial.
    #[serde(rename = "bad")]
    Rejected {
        /// Number of the trial.
        trial: u32,
        /// Reason.
        why: RejectReason,
    },
    /// Regular end of the session.
    Over,
    /// Lines that are lost; never written.
    #[serde(skip)]
    Damage {
        /// Number of lines.
        lines: u32,
    },
}

impl Entry {
    /// Entry for an output of a session.
    pub fn of(output: Output) -> Self {
        match output {
            Output::Round { number, at } => Self::Round { number, at: at.0 },
            Output::Cue { at, cue, trial } => Self::Cue {
                at: at.0,
                cue: cue.map(|motion| motion.name().to_owned()),
                trial,
            },
            Output::Rejected { trial, why } => Self::Rejected { trial, why },
            Output::Pause => Self::Break,
            Output::Over => Self::Over,
        }
    }

    /// Entry of consecutive samples from an index on.
    pub fn samples(first: SampleIndex, samples: &[Sample]) -> Self {
        let mut emg = String::with_capacity(samples.len() * 2 * CHANNELS);
        for value in samples.iter().flatten() {
            // Writing to a string cannot fail.
            let _ = write!(emg, "{:02x}", value.cast_unsigned());
        }
        let first = first.0;
        Self::Samples { first, emg }
    }

    /// Decodes the samples of their digits; none if the text is malformed.
    pub fn decoded(emg: &str) -> Option<Vec<Sample>> {
        let value = |pair: &[u8; 2]| {
            let text = std::str::from_utf8(pair).ok()?;
            u8::from_str_radix(text, 16).ok().map(u8::cast_signed)
        };
        let (pairs, rest) = emg.as_bytes().as_chunks::<2>();
        let values: Vec<i8> = pairs.iter().map(value).collect::<Option<_>>()?;
        let (samples, more) = values.as_chunks::<CHANNELS>();
        (rest.is_empty() && more.is_empty()).then(|| samples.to_vec())
    }

    /// Motion of a cue by its name; unknown without one.
    pub fn motion(cue: Option<&String>) -> Motion {
        cue.and_then(|name| Motion::from_name(name))
            .unwrap_or(Motion::Unknown)
    }

    /// Formats the line of a number, with its end.
    pub fn line(&self, number: u32) -> String {
        // Strings, numbers and lists of strings always become JSON.
        let json = serde_json::to_string(self).unwrap_or_default();
        let text = format!("{number} {json}");
        format!("{:08x} {text}\n", CRC.checksum(text.as_bytes()))
    }

    /// Parses a line without its end; none if it is damaged.
    pub fn parse(line: &[u8]) -> Option<(u32, Self)> {
        let (checksum, text) = line.split_at_checked(8)?;
        let text = text.strip_prefix(b" ")?;
        let checksum = std::str::from_utf8(checksum).ok()?;
        let expected = u32::from_str_radix(checksum, 16).ok()?;
        if expected != CRC.checksum(text) {
            return None;
        }
        let json = text.iter().position(|&byte| byte == b'{')?;
        let number = std::str::from_utf8(&text[..json]).ok()?.trim_end();
        Some((
            number.parse().ok()?,
            serde_json::from_slice(&text[json..]).ok()?,
        ))
    }

    /// Whether bytes are the beginning of a line: its checksum, its number, and JSON that ends where they do.
    pub fn is_begun(bytes: &[u8]) -> bool {
        let (checksum, rest) = bytes.split_at(bytes.len().min(8));
        let rest = rest.strip_prefix(b" ").unwrap_or(rest);
        let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        // A number that ends behind its sign is no JSON, for the parser.
        let json = rest[digits..].strip_suffix(b"-").unwrap_or(&rest[digits..]);
        let json = serde_json::from_slice::<IgnoredAny>(json);
        checksum.iter().all(u8::is_ascii_hexdigit) && json.err().is_none_or(|error| error.is_eof())
    }

    /// Number of lines that ran into each other in a damaged one, as far as their JSON shows it.
    pub fn count(damaged: &[u8]) -> u32 {
        let begun = damaged.windows(JSON.len()).filter(|part| *part == JSON);
        (begun.count() as u32).max(1)
    }
}
