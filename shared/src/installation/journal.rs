//! The journal of an installation: a page of flash of its own, which outlasts a loss of power.
//!
//! ```text
//! 0..4        "MyoI"
//! 4..8        bytes of the file, little-endian
//! 8..12       its CRC-32, little-endian
//! 12..16      CRC-32 of the bytes before, little-endian
//! 16 + 4 p    a word of zeros once page p of the region is written: from 1 on, one after the other
//! ```
//!
//! Each word is written once after an erasure.

use super::Transfer;
use crate::checksum::crc32;

/// Bytes of the record.
pub const RECORD_BYTES: usize = 16;
/// The longest journal: of a region of 64 pages.
pub const JOURNAL_BYTES: usize = RECORD_BYTES + 64 * 4;
/// A record, at the start of the page.
pub type Record = [u8; RECORD_BYTES];

const MAGIC: [u8; 4] = *b"MyoI";
const COVERED: usize = RECORD_BYTES - 4;

/// Content of a journal.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Journal {
    /// File that comes.
    pub transfer: Transfer,
    /// Pages that are written, from the second on.
    pub marked: u32,
}

/// The record of a transfer.
#[must_use]
#[inline(never)]
pub fn to_record(transfer: Transfer) -> Record {
    let mut record = [0; RECORD_BYTES];
    record[..4].copy_from_slice(&MAGIC);
    record[4..8].copy_from_slice(&transfer.length.to_le_bytes());
    record[8..COVERED].copy_from_slice(&transfer.checksum.to_le_bytes());
    let checksum = crc32(&record[..COVERED]);
    record[COVERED..].copy_from_slice(&checksum.to_le_bytes());
    record
}

/// Offset of the mark of a page: a word of zeros.
#[must_use]
pub const fn mark(page: u32) -> u32 {
    RECORD_BYTES as u32 + 4 * page
}

/// The record at the start of the page; none if it is not whole.
#[must_use]
pub fn read(page: &[u8; JOURNAL_BYTES]) -> Option<Journal> {
    let (record, marks) = page.split_first_chunk::<RECORD_BYTES>()?;
    let [_, length, checksum, _] = [0, 4, 8, 12].map(|place| {
        let bytes = [0, 1, 2, 3].map(|byte| record[place + byte]);
        u32::from_le_bytes(bytes)
    });
    let transfer = Transfer { length, checksum };
    if to_record(transfer) != *record {
        return None;
    }
    let (marks, _) = marks.as_chunks::<4>();
    // The first page has no mark.
    let marked = marks[1..]
        .iter()
        .take_while(|mark| **mark == [0; 4])
        .count();
    Some(Journal {
        transfer,
        marked: u32::try_from(marked).unwrap_or(0),
    })
}
