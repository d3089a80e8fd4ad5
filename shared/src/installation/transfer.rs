//! File that is exchanged, and its blocks in the order in which they are asked for.

/// Bytes of a block; the file's last one is filled up with ones, as erased flash is.
pub const BLOCK_BYTES: usize = 64;
/// Bytes of a page, which flash is erased by.
pub const PAGE_BYTES: usize = 4096;
pub(super) const PAGE_BLOCKS: u32 = (PAGE_BYTES / BLOCK_BYTES) as u32;

/// File that is exchanged.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Transfer {
    /// Length of the file in bytes.
    pub length: u32,
    /// CRC-32 of the file: the last four bytes of a model file.
    pub checksum: u32,
}

/// A part of the file.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[repr(align(4))]
pub struct Block(pub [u8; BLOCK_BYTES]);

impl Block {
    /// Content of a block that is not written.
    pub const ERASED: Self = Self([0xff; BLOCK_BYTES]);

    /// The block of a file; all ones behind its end.
    #[must_use]
    pub fn of(file: &[u8], number: u32) -> Self {
        let mut block = Self::ERASED;
        let from = number as usize * BLOCK_BYTES;
        let rest = file.get(from..).unwrap_or_default();
        let length = rest.len().min(BLOCK_BYTES);
        block.0[..length].copy_from_slice(&rest[..length]);
        block
    }
}

impl Transfer {
    /// The exchange for a model file.
    #[must_use]
    pub fn of(file: &[u8]) -> Self {
        let checksum = file.last_chunk().copied().unwrap_or_default();
        Self {
            length: file.len() as u32,
            checksum: u32::from_le_bytes(checksum),
        }
    }

    /// Blocks of the file.
    #[must_use]
    pub const fn blocks(self) -> u32 {
        self.length.div_ceil(BLOCK_BYTES as u32)
    }

    /// Pages of the file.
    #[must_use]
    pub const fn pages(self) -> u32 {
        self.blocks().div_ceil(PAGE_BLOCKS)
    }

    /// Blocks that lie on other pages than the first.
    pub(super) const fn later(self) -> u32 {
        self.blocks().saturating_sub(PAGE_BLOCKS)
    }

    /// The block that is asked for after `taken` others: the first, those of the later pages, those of the first page.
    pub(super) const fn block(self, taken: u32) -> u32 {
        match taken {
            0 => 0,
            _ if taken <= self.later() => PAGE_BLOCKS - 1 + taken,
            _ => taken - self.later(),
        }
    }

    /// Number of blocks that are requested before this one.
    #[must_use]
    pub const fn before(self, block: u32) -> u32 {
        match block {
            0 => 0,
            _ if block >= PAGE_BLOCKS => block - (PAGE_BLOCKS - 1),
            _ => block + self.later(),
        }
    }
}
