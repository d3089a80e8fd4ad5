//! Fingerprints of content: of configurations, recordings and weights.
//!
//! CRC-64 shows accidental differences, not forgery.

use std::fmt;
use std::str::FromStr;

use crc::{CRC_64_XZ, Crc, Table};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// CRC-64/XZ of some content; 16 hexadecimal digits in files.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Fingerprint(u64);

impl Fingerprint {
    /// Fingerprint of bytes.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(CRC.checksum(bytes))
    }

    /// Fingerprint of the JSON text of a value, whose fields have a fixed order.
    ///
    /// # Panics
    /// When the value cannot be written as JSON: it has a map whose keys are not strings.
    pub fn of(value: &impl Serialize) -> Self {
        let text = serde_json::to_vec(value).expect("a value with a JSON text");
        Self::of_bytes(&text)
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl FromStr for Fingerprint {
    type Err = std::num::ParseIntError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        u64::from_str_radix(text, 16).map(Self)
    }
}

impl Serialize for Fingerprint {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Fingerprint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fingerprint_survives_being_written_and_is_the_published_check_value() {
        // The check value of CRC-64/XZ, of the digits 1 to 9.
        let print = Fingerprint::of_bytes(b"123456789");
        assert_eq!(print.to_string(), "995dc9bbdf1939fa");
        let text = serde_json::to_string(&print).unwrap();
        assert_eq!(serde_json::from_str::<Fingerprint>(&text).unwrap(), print);
    }
}
