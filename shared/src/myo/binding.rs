//! The record of the bound armband, as a device keeps it over resets.
//!
//! ```text
//! 0..4    "MyoB"
//! 4       format version, 1
//! 5       kind of the address: 0 public, 1 random
//! 6..12   the address, little-endian as on air
//! 12..16  CRC-32 of the bytes before, little-endian
//! ```
//!
//! A record that is not whole, such as one whose writing was interrupted, is no record: never a wrong address. Flash is
//! erased, so all ones, before a record is written, and memory may hold anything before the first one.

use super::address::{Address, AddressKind};
use crate::checksum::crc32;

/// Bytes of a record: whole words, as flash is written.
pub const RECORD_BYTES: usize = 16;

const MAGIC: [u8; 4] = *b"MyoB";
const VERSION: u8 = 1;
/// Bytes that the checksum covers.
const COVERED: usize = RECORD_BYTES - 4;

/// The record of an armband.
#[must_use]
#[inline(never)]
pub fn to_record(armband: Address) -> [u8; RECORD_BYTES] {
    let kind = match armband.kind {
        AddressKind::Public => 0,
        AddressKind::Random => 1,
    };
    let mut record = [0; RECORD_BYTES];
    record[..4].copy_from_slice(&MAGIC);
    record[4..6].copy_from_slice(&[VERSION, kind]);
    record[6..COVERED].copy_from_slice(&armband.bytes);
    let checksum = crc32(&record[..COVERED]);
    record[COVERED..].copy_from_slice(&checksum.to_le_bytes());
    record
}

/// The armband of a record; `None` if the record is not whole.
#[must_use]
pub fn from_record(record: &[u8; RECORD_BYTES]) -> Option<Address> {
    let [m, y, o, b, version, kind, address @ .., _, _, _, _] = *record;
    let armband = Address {
        kind: match kind {
            0 => AddressKind::Public,
            1 => AddressKind::Random,
            _ => return None,
        },
        bytes: address,
    };
    let is_whole = [m, y, o, b] == MAGIC && version == VERSION && to_record(armband) == *record;
    is_whole.then_some(armband)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ARMBAND: Address = Address {
        kind: AddressKind::Public,
        bytes: [0x9a, 0x78, 0x56, 0x34, 0x12, 0xfa],
    };

    #[test]
    fn the_record_is_that_of_the_documentation() {
        let record = to_record(ARMBAND);
        assert_eq!(record[..6], *b"MyoB\x01\x00");
        assert_eq!(record[6..12], ARMBAND.bytes);
        // The CRC-32 of zlib: Python's binascii.crc32.
        assert_eq!(record[12..], 0xd193_802d_u32.to_le_bytes());
    }

    #[test]
    fn a_record_that_was_not_written_to_its_end_or_at_all_is_none() {
        let record = to_record(ARMBAND);
        for before in [0xff, 0] {
            for written in 0..RECORD_BYTES {
                let mut half = [before; RECORD_BYTES];
                half[..written].copy_from_slice(&record[..written]);
                let expected = (half == record).then_some(ARMBAND);
                assert_eq!(from_record(&half), expected, "{written} bytes");
            }
        }
    }

    proptest! {
        #[test]
        fn bits_that_were_not_programmed_are_no_other_armband(bytes: [u8; 6], lost: [u8; 16]) {
            let armband = Address { kind: AddressKind::Public, bytes };
            let mut record = to_record(armband);
            // Flash is programmed from ones to zeros.
            for (byte, lost) in record.iter_mut().zip(lost) {
                *byte |= lost;
            }
            let found = from_record(&record);
            prop_assert!(found.is_none() || found == Some(armband));
        }
    }
}
