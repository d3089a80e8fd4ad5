//! Damaged model files, and why the device refuses each.

use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, random::random_model};

use super::MODEL_REGION;

/// A damaged file.
pub struct Damage {
    /// Description of the damage.
    pub name: &'static str,
    /// The model's region from its start; the rest is erased flash.
    pub bytes: Vec<u8>,
}

impl Damage {
    /// The error that the region is refused with; none if it is accepted.
    #[must_use]
    pub fn reason(&self) -> Option<String> {
        let mut region = vec![0xff; MODEL_REGION];
        region[..self.bytes.len()].copy_from_slice(&self.bytes);
        let encoder = Model::parse(&region).and_then(|model| DeviceEncoder::new(&model).map(drop));
        encoder.err().map(|error| error.to_string())
    }
}

/// Every kind of damage, done to a good model.
///
/// # Panics
/// If `good` is too short for a model.
#[must_use]
pub fn damages(good: &[u8]) -> Vec<Damage> {
    let changed = |name, change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = good.to_vec();
        change(&mut bytes);
        Damage { name, bytes }
    };
    let shape = Dimensions {
        width: 72,
        layers: 2,
        span: 27,
        vocabulary: Vocabulary::Three,
        other: false,
    };
    let too_wide = random_model(shape, 1).to_bytes();
    vec![
        changed("an erased region", &|bytes| bytes.fill(0xff)),
        changed("another magic", &|bytes| bytes[0] ^= 0x20),
        changed("another format version", &|bytes| bytes[8] += 1),
        changed("a length beyond the region", &|bytes| {
            let beyond = u32::try_from(MODEL_REGION + 1).expect("small");
            bytes[9..13].copy_from_slice(&beyond.to_le_bytes());
        }),
        changed("a length too short for the file", &|bytes| {
            let short = u32::try_from(good.len() - 100).expect("small");
            bytes[9..13].copy_from_slice(&short.to_le_bytes());
        }),
        changed("a flipped bit in a weight", &|bytes| {
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
        }),
        changed("a flipped bit in the checksum", &|bytes| {
            let last = bytes.len() - 1;
            bytes[last] ^= 1;
        }),
        changed("an end that was never written", &|bytes| {
            bytes.truncate(good.len() / 2)
        }),
        Damage {
            name: "a good model wider than the device has room for",
            bytes: too_wide.expect("a writable model"),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn each_damage_has_its_reason_and_the_whole_model_has_none() {
        let shape = Dimensions {
            width: 48,
            layers: 2,
            span: 27,
            vocabulary: Vocabulary::Three,
            other: false,
        };
        let good = random_model(shape, 1).to_bytes().unwrap();
        let damages = damages(&good);
        let kinds: BTreeSet<_> = damages.iter().map(|d| d.reason().expect(d.name)).collect();
        // Both kinds of truncation are found by the checksum, with different sums.
        assert_eq!(kinds.len(), damages.len());
        let whole = Damage {
            name: "none",
            bytes: good,
        };
        assert_eq!(whole.reason(), None);
    }
}
