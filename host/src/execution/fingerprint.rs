//! A fingerprint of content: which configuration, which recordings, which weights.
//!
//! CRC-64 tells apart what differs by accident, not what somebody forges.

use std::fmt;
use std::str::FromStr;

use burn::module::{Module, ModuleVisitor, Param};
use burn::tensor::Tensor;
use crc::{CRC_64_XZ, Crc, Digest, Table};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

static CRC: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// CRC-64/XZ of some content; 16 hexadecimal digits in files.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Fingerprint(u64);

impl Fingerprint {
    /// Of bytes.
    #[must_use]
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(CRC.checksum(bytes))
    }

    /// Of the JSON text of a value, whose fields have a fixed order.
    ///
    /// # Panics
    /// When the value cannot be written as JSON: it has a map whose keys are no strings.
    #[must_use]
    pub fn of(value: &impl Serialize) -> Self {
        let text = serde_json::to_vec(value).expect("a value with a JSON text");
        Self::of_bytes(&text)
    }

    /// Of the values of a model's weights, in the order in which the module visits them.
    ///
    /// Not of a file of them, which also holds identifiers that are drawn anew for every model.
    #[must_use]
    pub(crate) fn of_weights(model: &impl Module) -> Self {
        let mut weights = Weights(CRC.digest());
        model.visit(&mut weights);
        Self(weights.0.finalize())
    }
}

struct Weights<'a>(Digest<'a, u64, Table<16>>);

impl ModuleVisitor for Weights<'_> {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        for value in param.val().into_data().iter::<f32>() {
            self.0.update(&value.to_le_bytes());
        }
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
