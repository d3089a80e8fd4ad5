//! CRC-32 as Ethernet, zip and PNG compute it, of a few bytes: without a table.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

const CHECKSUM: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The checksum of some bytes.
// Not inlined: the loop is unrolled, and has several callers.
#[inline(never)]
pub(crate) fn crc32(bytes: &[u8]) -> u32 {
    CHECKSUM.checksum(bytes)
}
