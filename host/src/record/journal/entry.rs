//! A line of a journal: `5f3a0c11 {"is":"cue",...}`, CRC-32 of what follows, and JSON.

use std::fmt::Write as _;

use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Deserialize, Serialize};
use shared::intent::Intent;
use shared::units::{CHANNELS, Sample, SampleIndex};

use crate::record::session::{Bad, Output};

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
/// Of this description.
pub(super) const FORMAT: u32 = 1;

/// What a session is of.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Header {
    /// Version of the journal's format.
    pub format: u32,
    /// Of the program.
    pub version: String,
    /// When it began, UTC.
    pub began: String,
    /// Whose muscles.
    pub person: String,
    /// Name of the protocol.
    pub protocol: String,
    /// Classes that it asks for.
    pub classes: Vec<String>,
    /// Whether the person says what is done.
    pub free: bool,
    /// Where the samples come from.
    pub source: String,
    /// Whether nobody's muscles made them.
    pub synthetic: bool,
}

/// What happened.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(tag = "is", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Entry {
    /// First line.
    Begin(Header),
    /// Consecutive samples, 16 hexadecimal digits each.
    Samples {
        /// Index of the first.
        first: u32,
        /// The samples.
        emg: String,
    },
    /// How the armband sits from the next sample on, as the board was aligned to it.
    Placement {
        /// Places that it is turned by.
        turn: u8,
        /// Whether it is on the other arm.
        mirrored: bool,
    },
    /// What follows does not continue what was before.
    Break,
    /// A round begins.
    Round {
        /// From 1 on.
        number: u32,
        /// Its first sample.
        at: u32,
    },
    /// Something is asked for, or nothing.
    Cue {
        /// First sample.
        at: u32,
        /// A class.
        cue: Option<String>,
        /// Number of the attempt.
        trial: u32,
    },
    /// A trial is not to be used.
    Bad {
        /// Its number.
        trial: u32,
        /// Why.
        why: Bad,
    },
    /// The session came to its end.
    Over,
}

impl Entry {
    /// What a session says.
    #[must_use]
    pub fn of(output: Output) -> Self {
        match output {
            Output::Round { number, at } => Self::Round { number, at: at.0 },
            Output::Cue { at, cue, trial } => Self::Cue {
                at: at.0,
                cue: cue.map(|intent| intent.name().to_owned()),
                trial,
            },
            Output::Bad { trial, why } => Self::Bad { trial, why },
            Output::Pause => Self::Break,
            Output::Over => Self::Over,
        }
    }

    /// Samples from an index on.
    #[must_use]
    pub fn samples(first: SampleIndex, samples: &[Sample]) -> Self {
        let mut emg = String::with_capacity(samples.len() * 2 * CHANNELS);
        for value in samples.iter().flatten() {
            // Writing to a string cannot fail.
            let _ = write!(emg, "{:02x}", value.cast_unsigned());
        }
        let first = first.0;
        Self::Samples { first, emg }
    }

    /// The samples of their digits; none if these are no samples.
    #[must_use]
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

    /// The class of a cue's name.
    #[must_use]
    pub fn intent(cue: Option<&String>) -> Option<Intent> {
        Intent::from_name(cue?)
    }

    /// The line, with its end.
    pub(super) fn line(&self) -> String {
        // Strings, numbers and lists of strings always become JSON.
        let json = serde_json::to_string(self).unwrap_or_default();
        format!("{:08x} {json}\n", CRC.checksum(json.as_bytes()))
    }

    /// The entry of a line without its end; none if it is damaged.
    pub(super) fn parse(line: &[u8]) -> Option<Self> {
        let (checksum, json) = line.split_at_checked(8)?;
        let json = json.strip_prefix(b" ")?;
        let checksum = std::str::from_utf8(checksum).ok()?;
        let expected = u32::from_str_radix(checksum, 16).ok()?;
        if expected != CRC.checksum(json) {
            return None;
        }
        serde_json::from_slice(json).ok()
    }
}
