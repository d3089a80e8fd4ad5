//! UF2 files, which a board's boot loader takes as files that are dragged onto its drive.
//!
//! Blocks of 512 bytes, each with an address and 256 bytes for flash. Source: github.com/microsoft/uf2, README. Adafruit's boot
//! loader for the nRF52840 takes no other length, asks for the family, and writes from 0x1000 to 0xEA000. It erases what it
//! writes, by pages of 4 KiB, and keeps the rest of a page.

/// Bytes of a block of the file.
pub const BLOCK_BYTES: usize = 512;
/// Bytes of flash in a block.
const PAYLOAD: u32 = 256;
/// Family of the nRF52840 with Adafruit's boot loader.
const FAMILY: u32 = 0xADA5_2840;
/// Flag: the block has a family.
const HAS_FAMILY: u32 = 0x2000;
const BEGINS: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const ENDS: u32 = 0x0AB1_6F30;

/// Address of the journal of an installation, as in `memory.x`.
pub const JOURNAL: u32 = 0x5_6000;
/// Address of the model's region, as in `memory.x`.
pub const MODEL: u32 = 0x5_8000;
/// Erased journal: the model is whole.
const ERASED_JOURNAL: &[u8] = &[0xff; 4096];

/// Segments of a file that puts this model in use: addresses and bytes.
#[must_use]
pub const fn model(file: &[u8]) -> [(u32, &[u8]); 2] {
    [(JOURNAL, ERASED_JOURNAL), (MODEL, file)]
}

/// Blocks of a file with these segments of flash: addresses and bytes. Between them and behind them flash stays as it is, but for
/// the rest of 256 bytes.
pub fn blocks<'s>(segments: &'s [(u32, &'s [u8])]) -> impl Iterator<Item = [u8; BLOCK_BYTES]> + 's {
    let count = pages(segments).count() as u32;
    (0..).zip(pages(segments)).map(move |(number, page)| {
        let header = [
            BEGINS[0], BEGINS[1], HAS_FAMILY, page, PAYLOAD, number, count, FAMILY,
        ];
        let mut block = [0; BLOCK_BYTES];
        let (words, _) = block.as_chunks_mut();
        for (word, value) in words.iter_mut().zip(header) {
            *word = value.to_le_bytes();
        }
        let (_, rest) = block.split_at_mut(4 * header.len());
        for (address, byte) in (page..page + PAYLOAD).zip(rest) {
            *byte = at(segments, address).unwrap_or(0xff);
        }
        if let Some(end) = block.last_chunk_mut() {
            *end = ENDS.to_le_bytes();
        }
        block
    })
}

/// The byte at an address.
fn at(segments: &[(u32, &[u8])], address: u32) -> Option<u8> {
    segments.iter().find_map(|(start, bytes)| {
        let place = address.checked_sub(*start)?;
        bytes.get(place as usize).copied()
    })
}

/// Addresses of the parts of 256 bytes that have any byte, in order.
fn pages<'s>(segments: &'s [(u32, &'s [u8])]) -> impl Iterator<Item = u32> + 's {
    let end_of = |(start, bytes): &(u32, &[u8])| start + bytes.len() as u32;
    let start = segments
        .iter()
        .map(|(start, _)| start / PAYLOAD * PAYLOAD)
        .min();
    let end = segments.iter().map(end_of).max();
    let all = start.unwrap_or(0)..end.unwrap_or(0);
    all.step_by(PAYLOAD as usize).filter(move |page| {
        let touches = |one: &(u32, &[u8])| one.0 < page + PAYLOAD && end_of(one) > *page;
        segments.iter().any(touches)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn segments_that_share_256_bytes_are_one_block_and_gaps_have_none() {
        let segments: [(u32, &[u8]); 3] = [(0x1000, &[1; 250]), (0x10fc, &[2; 8]), (0x2010, &[3])];
        let all: Vec<_> = blocks(&segments).collect();
        let address =
            |block: &[u8; 512]| u32::from_le_bytes([block[12], block[13], block[14], block[15]]);
        let addresses: Vec<_> = all.iter().map(address).collect();
        assert_eq!(addresses, [0x1000, 0x1100, 0x2000]);
        let data = |number: usize| &all[number][32..288];
        assert_eq!(data(0)[248..], [1, 1, 0xff, 0xff, 2, 2, 2, 2]);
        assert_eq!(data(1)[..5], [2, 2, 2, 2, 0xff]);
        assert_eq!(data(2)[15..18], [0xff, 3, 0xff]);
        assert!(
            all.iter()
                .all(|block| block[288..508].iter().all(|byte| *byte == 0))
        );
    }

    #[test]
    fn nothing_has_no_block() {
        assert_eq!(blocks(&[]).count(), 0);
        assert_eq!(blocks(&[(0x1000, &[])]).count(), 0);
    }
}
