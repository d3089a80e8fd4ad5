//! UF2 files: contents of flash, to be dragged onto a boot loader's drive.
//!
//! Blocks of 512 bytes, each with an address and 256 bytes for flash. Source: github.com/microsoft/uf2, README. Adafruit's boot
//! loader for the nRF52840 takes no other length, asks for the family, and writes from 0x1000 to 0xEA000. It erases what it
//! writes, by pages of 4 KiB, and keeps the rest of a page.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use core::ops::Range;

/// Bytes of a block of the file.
const BLOCK: usize = 512;
/// Bytes of a block before its payload.
const HEADER: usize = 32;
/// Bytes of flash in a block.
const PAYLOAD: usize = 256;
/// Family of the nRF52840 with Adafruit's boot loader.
const FAMILY: u32 = 0xADA5_2840;
/// Flag: the block is a comment, not for main flash. A reader skips it, unless it is part of a file.
const NOT_MAIN_FLASH: u32 = 0x1;
/// Flag: the block is part of a file for a file system.
const IN_A_FILE: u32 = 0x1000;
/// Flag: the block has a family.
const HAS_FAMILY: u32 = 0x2000;
const BEGINS: [u32; 2] = [0x0A32_4655, 0x9E5D_5157];
const ENDS: u32 = 0x0AB1_6F30;
/// Addresses that the boot loader writes.
const WINDOW: Range<u32> = 0x1000..0xE_A000;
/// Page that says how far an installation of a model is, as in `memory.x`.
const JOURNAL: u32 = 0x5_6000;
/// Bytes of a page of flash.
const PAGE: usize = 4096;
/// Region of the program, as in `memory.x`.
pub const PROGRAM_REGION: Range<u32> = WINDOW.start..0x5_5000;
/// Region of the model file, as in `memory.x`.
pub const MODEL_REGION: Range<u32> = 0x5_8000..0x8_0000;

/// Reason why a file is refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Uf2Error {
    #[error(
        "block {block} is not a UF2 block for an nRF52840 with Adafruit's boot loader: build or download the file again"
    )]
    Block { block: usize },
    #[error(
        "expected {expected} blocks of 512 bytes, found {found}: copy or download the file again"
    )]
    Count { expected: usize, found: usize },
    #[error("the model file has {length} bytes, its region {}: train a smaller model", MODEL_REGION.len())]
    Model { length: usize },
}

/// Contents of flash, by pieces of 256 bytes.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Uf2(BTreeMap<u32, [u8; PAYLOAD]>);

impl Uf2 {
    /// Reads a file.
    ///
    /// # Errors
    /// The file is of another family, is damaged, or is not whole.
    pub fn parse(file: &[u8]) -> Result<Self, Uf2Error> {
        let (blocks, rest) = file.as_chunks::<BLOCK>();
        let mut all = BTreeMap::new();
        let mut expected = 1;
        for (number, block) in blocks.iter().enumerate() {
            let (words, _) = block.as_chunks::<4>();
            let word = |at: usize| u32::from_le_bytes(words[at / 4]);
            let refused = Uf2Error::Block { block: number };
            if number == 0 {
                expected = word(24) as usize;
            }
            let is_one = [word(0), word(4)] == BEGINS && word(BLOCK - 4) == ENDS;
            let is_next = word(20) as usize == number && word(24) as usize == expected;
            let (flags, address) = (word(8), word(12));
            if !is_one || !is_next || flags & IN_A_FILE != 0 {
                return Err(refused);
            }
            if flags & NOT_MAIN_FLASH != 0 {
                continue;
            }
            let is_ours = flags & HAS_FAMILY != 0 && word(28) == FAMILY;
            let is_placed = WINDOW.contains(&address) && address.is_multiple_of(PAYLOAD as u32);
            let mut payload = [0; PAYLOAD];
            payload.copy_from_slice(&block[HEADER..][..PAYLOAD]);
            let is_right = is_ours && is_placed && word(16) as usize == PAYLOAD;
            if !is_right || all.insert(address, payload).is_some() {
                return Err(refused);
            }
        }
        let found = blocks.len();
        if found != expected || !rest.is_empty() {
            return Err(Uf2Error::Count { expected, found });
        }
        Ok(Self(all))
    }

    /// Puts bytes at an address. The rest of 256 bytes is erased flash, unless something else was put there.
    pub fn put(&mut self, start: u32, bytes: &[u8]) {
        for (address, byte) in (start..).zip(bytes) {
            let place = address % PAYLOAD as u32;
            let payload = self.0.entry(address - place).or_insert([0xff; PAYLOAD]);
            payload[place as usize] = *byte;
        }
    }

    /// Puts a model file into its region in place of another one, and erases the page that says how far an installation is.
    pub fn put_model(&mut self, file: &[u8]) -> Result<(), Uf2Error> {
        if file.len() > MODEL_REGION.len() {
            return Err(Uf2Error::Model { length: file.len() });
        }
        self.0.retain(|address, _| !MODEL_REGION.contains(address));
        self.put(MODEL_REGION.start, file);
        self.put(JOURNAL, &[0xff; PAGE]);
        Ok(())
    }

    /// Flash from the start of a range to the last piece in it, erased between the pieces; empty without a piece.
    #[must_use]
    pub fn bytes(&self, range: Range<u32>) -> Vec<u8> {
        let start = range.start;
        let mut bytes = Vec::new();
        for (address, piece) in self.0.range(range) {
            bytes.resize((address - start) as usize, 0xff);
            bytes.extend_from_slice(piece);
        }
        bytes
    }

    /// The file, block by block.
    #[must_use]
    pub fn file(&self) -> Vec<u8> {
        let count = self.0.len() as u32;
        let mut file = Vec::with_capacity(self.0.len() * BLOCK);
        for (number, (address, payload)) in (0..).zip(&self.0) {
            let length = PAYLOAD as u32;
            let [first, second] = BEGINS;
            let header = [
                first, second, HAS_FAMILY, *address, length, number, count, FAMILY,
            ];
            file.extend_from_slice(header.map(u32::to_le_bytes).as_flattened());
            file.extend_from_slice(payload);
            file.extend_from_slice(&[0; BLOCK - HEADER - PAYLOAD - 4]);
            file.extend_from_slice(&ENDS.to_le_bytes());
        }
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn segments_that_share_256_bytes_are_one_block_and_gaps_have_none() {
        let mut all = Uf2::default();
        all.put(0x1000, &[1; 250]);
        all.put(0x10fc, &[2; 8]);
        all.put(0x2010, &[3]);
        let file = all.file();
        let (blocks, rest) = file.as_chunks::<BLOCK>();
        assert!(rest.is_empty());
        let address = |block: &[u8; BLOCK]| [block[12], block[13], block[14], block[15]];
        let addresses = [0x1000, 0x1100, 0x2000_u32].map(u32::to_le_bytes);
        assert!(blocks.iter().map(address).eq(addresses));
        let data = |number: usize| &blocks[number][32..288];
        assert_eq!(data(0)[248..], [1, 1, 0xff, 0xff, 2, 2, 2, 2]);
        assert_eq!(data(1)[..5], [2, 2, 2, 2, 0xff]);
        assert_eq!(data(2)[15..18], [0xff, 3, 0xff]);
        assert!(blocks.iter().all(|block| block[288..508] == [0; 220]));
        assert_eq!(Uf2::parse(&file), Ok(all));
    }

    #[test]
    fn a_shorter_model_leaves_nothing_of_a_longer_one() {
        let mut image = Uf2::default();
        image.put(0x1000, &[7; 512]);
        let alone = image.clone();
        image.put_model(&[1; 1000]).unwrap();
        image.put_model(&[2; 10]).unwrap();
        let mut expected = alone;
        expected.put(0x5_6000, &[0xff; 4096]);
        expected.put(0x5_8000, &[2; 10]);
        assert_eq!(image, expected);
        assert_eq!(image.bytes(0x1000..0x5_6000), [7; 512]);
        let long = vec![0; MODEL_REGION.len() + 1];
        let refused = Err(Uf2Error::Model { length: long.len() });
        assert_eq!(image.put_model(&long), refused);
        assert_eq!(image.put_model(&long[1..]), Ok(()));
    }

    /// Three blocks.
    fn three() -> (Uf2, Vec<u8>) {
        let mut all = Uf2::default();
        all.put(0x1000, &[1; 700]);
        let file = all.file();
        (all, file)
    }

    #[test]
    fn every_damaged_file_is_refused() {
        let (_, file) = three();
        for (length, expected) in [(0, 1), (511, 1), (1024, 3), (1535, 3)] {
            let found = length / 512;
            let refused = Err(Uf2Error::Count { expected, found });
            assert_eq!(Uf2::parse(&file[..length]), refused, "{length} bytes");
        }
        // Both magic words, flags, address, length, number, family, the last word; of the second block.
        for place in [0, 4, 9, 12, 15, 17, 20, 28, 508] {
            let mut damaged = file.clone();
            damaged[512 + place] ^= 0x31;
            let refused = Err(Uf2Error::Block { block: 1 });
            assert_eq!(Uf2::parse(&damaged), refused, "{place}");
        }
        // The address of the first block again, and other numbers of blocks.
        for (block, place, word) in [(1, 12, 0x1000_u32), (1, 24, 2), (1, 24, 4), (2, 24, 2)] {
            let mut file = file.clone();
            file[block * BLOCK + place..][..4].copy_from_slice(&word.to_le_bytes());
            let refused = Err(Uf2Error::Block { block });
            assert_eq!(Uf2::parse(&file), refused, "{word:#x} at {place}");
        }
    }

    /// A file with one more block at a place, which numbers count.
    fn with_block(file: &[u8], at: usize, change: impl Fn(&mut [u8; BLOCK])) -> Vec<u8> {
        let mut blocks = file.as_chunks::<BLOCK>().0.to_vec();
        let mut block = blocks[0];
        change(&mut block);
        blocks.insert(at, block);
        let count = blocks.len() as u32;
        for (number, block) in (0_u32..).zip(&mut blocks) {
            block[20..24].copy_from_slice(&number.to_le_bytes());
            block[24..28].copy_from_slice(&count.to_le_bytes());
        }
        blocks.into_flattened()
    }

    #[test]
    fn a_block_that_is_not_for_main_flash_writes_nothing_wherever_it_is() {
        let (all, file) = three();
        // Beside a family, another flag, or neither; with an address in flash, outside of it, or at no piece's start.
        for (flags, address, length) in [
            (0x2001_u32, 0x1000_u32, 256_u32),
            (0x6001, 0x5000, 476),
            (1, u32::MAX, 12),
        ] {
            for at in 0..=3 {
                let commented = with_block(&file, at, |block| {
                    block[8..12].copy_from_slice(&flags.to_le_bytes());
                    block[12..16].copy_from_slice(&address.to_le_bytes());
                    block[16..20].copy_from_slice(&length.to_le_bytes());
                    block[HEADER..HEADER + PAYLOAD].fill(9);
                });
                let found = Uf2::parse(&commented);
                assert_eq!(found, Ok(all.clone()), "{flags:#x} at {at}");
            }
        }
        // It is still a block; a block for a file system is not for flash.
        let torn = with_block(&file, 1, |block| (block[8], block[508]) = (1, 0));
        assert_eq!(Uf2::parse(&torn), Err(Uf2Error::Block { block: 1 }));
        for flags in [0x3000_u32, 0x3001] {
            let contained = with_block(&file, 3, |block| {
                block[8..12].copy_from_slice(&flags.to_le_bytes());
                block[12..16].copy_from_slice(&0x5000_u32.to_le_bytes());
            });
            assert_eq!(Uf2::parse(&contained), Err(Uf2Error::Block { block: 3 }));
        }
    }

    #[test]
    fn flash_between_pieces_is_erased() {
        let mut all = Uf2::default();
        all.put(0x5_8100, &[1; 256]);
        all.put(0x5_8300, &[2]);
        let bytes = all.bytes(MODEL_REGION);
        for gap in [&bytes[..256], &bytes[512..768]] {
            assert!(gap.iter().all(|byte| *byte == 0xff));
        }
        assert_eq!((bytes[256], bytes[768], bytes.len()), (1, 2, 1024));
        assert!(all.bytes(PROGRAM_REGION).is_empty());
    }
}
