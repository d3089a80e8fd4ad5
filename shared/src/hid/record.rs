//! The record of the outputs, as a device keeps it over resets.
//!
//! ```text
//! 0..4    "MyoH"
//! 4       format version, 1
//! 5       1 if they are on, else 0
//! 6..16   for each label from open on: kind, from 1, and value; zeros for none
//! 16..20  CRC-32 of the bytes before, little-endian
//! ```
//!
//! With an incomplete record the outputs are off.

use super::output::{HidKind, Output};
use super::{GESTURES, Settings};
use crate::checksum::crc32;

/// Bytes of a record: whole words, as flash is written.
pub const RECORD_BYTES: usize = 20;

const START: [u8; 5] = *b"MyoH\x01";
/// Bytes that the checksum covers.
const COVERED: usize = RECORD_BYTES - 4;
const _: () = assert!(START.len() + 1 + 2 * GESTURES == COVERED);

/// The record of settings.
#[must_use]
#[inline(never)]
pub fn to_record(settings: &Settings) -> [u8; RECORD_BYTES] {
    let mut record = [0; RECORD_BYTES];
    record[..START.len()].copy_from_slice(&START);
    record[START.len()] = settings.on.into();
    let places = record[START.len() + 1..COVERED].chunks_exact_mut(2);
    for (place, output) in places.zip(settings.outputs) {
        let bytes = output.map_or([0; 2], |output| [output.kind as u8 + 1, output.value]);
        place.copy_from_slice(&bytes);
    }
    let checksum = crc32(&record[..COVERED]);
    record[COVERED..].copy_from_slice(&checksum.to_le_bytes());
    record
}

/// The settings of a record; `None` if it is not whole.
#[must_use]
pub fn from_record(record: &[u8; RECORD_BYTES]) -> Option<Settings> {
    let mut places = record[START.len() + 1..COVERED].chunks_exact(2);
    let outputs = core::array::from_fn(|_| {
        let &[kind, value] = places.next()? else {
            return None;
        };
        let kind = HidKind::ALL.get(usize::from(kind).checked_sub(1)?)?;
        Output::new(*kind, value)
    });
    let settings = Settings {
        on: record[START.len()] == 1,
        outputs,
    };
    (to_record(&settings) == *record).then_some(settings)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> Settings {
        let outputs = ["key:space", "axis:rz-", "", "click:left", "button:16"];
        Settings {
            on: true,
            outputs: outputs.map(Output::from_name),
        }
    }

    #[test]
    fn the_record_is_that_of_the_documentation() {
        let record = to_record(&settings());
        let outputs = [1, 0x2c, 5, 11, 0, 0, 2, 0, 4, 15];
        assert_eq!(record[..6], *b"MyoH\x01\x01");
        assert_eq!(record[6..16], outputs);
        // The CRC-32 of zlib: Python's binascii.crc32.
        assert_eq!(record[16..], 0x4377_888a_u32.to_le_bytes());
        assert_eq!(from_record(&record), Some(settings()));
    }

    #[test]
    fn a_record_that_was_not_written_to_its_end_or_at_all_is_none() {
        let record = to_record(&settings());
        for (before, written) in
            (0..RECORD_BYTES).flat_map(|written| [(0xff, written), (0, written)])
        {
            let mut half = [before; RECORD_BYTES];
            half[..written].copy_from_slice(&record[..written]);
            assert_eq!(from_record(&half), None, "{written} bytes");
        }
    }
}
