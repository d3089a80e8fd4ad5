//! Damaged models: the board stays in the safe state, and the UART says why.

use std::collections::BTreeSet;

use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, random::random_model};

use super::start::FLASHED;
use myointent_tests::chip::{self, Board, MODEL_REGION, Setting};

/// A damaged file.
struct Damage {
    /// Description of the damage.
    name: &'static str,
    /// The model's region from its start; the rest is erased flash.
    bytes: Vec<u8>,
}

impl Damage {
    /// The error that the region is refused with; none if it is accepted.
    fn reason(&self) -> Option<String> {
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
fn damages(good: &[u8]) -> Vec<Damage> {
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

#[test]
fn every_damage_to_the_model_is_refused_with_its_reason() -> anyhow::Result<()> {
    let test = "every_damage_to_the_model_is_refused_with_its_reason";
    let damages = damages(&chip::model());
    let mut reasons = BTreeSet::new();
    for (number, damage) in damages.into_iter().enumerate() {
        let built = FLASHED[number % FLASHED.len()];
        let Some(image) = chip::image(test, built) else {
            return Ok(());
        };
        let reason = damage.reason().expect("a refusal on the PC too");
        let setting = Setting {
            model: damage.bytes,
            ..Setting::default()
        };
        let mut board = Board::new(built, image, setting);
        board.wait_for(&reason, 1000)?;
        board.wait_for("model-refused", 1000)?;
        let valid = board.machine.chip().level(board.pins.valid);
        assert_eq!(valid, Some(false), "{built}, {}", damage.name);
        reasons.insert(reason);
    }
    // Both kinds of truncation are found by the checksum, with different sums.
    assert_eq!(reasons.len(), 9);
    Ok(())
}
