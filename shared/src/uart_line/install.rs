//! The exchange of a model on the line: see [`installation`](crate::installation).
//!
//! ```text
//! "INSTALL," length "," crc                 begins, or continues, a file of this length and CRC-32
//! "BLOCK," number "," crc "," content       a block of it, with a CRC-32 of its own
//! content = the 64 bytes in Base64, 86 characters, without padding; ones behind the end of the file
//! crc     = eight lower-case hexadecimal digits
//! ```
//!
//! Both are answered with the number of the block that is missing next, or with `done`.

use core::fmt;

use super::ParseError;
use super::fields::{Crc, Fields, Reader, Writer, fields, wrong};
use crate::checksum::crc32;
use crate::installation::{BLOCK_BYTES, Block, Transfer};

/// Characters of a block's content: six bits each, the last two of the last one are zeros.
const CONTENT: usize = (BLOCK_BYTES * 8).div_ceil(6);
const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fields!(Transfer {
    length: u32,
    checksum: Crc
});

/// Codec of a block: its CRC-32, its content.
impl Fields<'_> for Block {
    type Value = Self;
    const COUNT: usize = 2;

    fn write(block: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        Crc::write(&crc32(&block.0), line)?;
        encode(block, line.field()?)
    }

    fn read(line: &mut Reader<'_>, name: &'static str) -> Result<Self, ParseError> {
        let expected = Crc::read(line, "crc")?;
        let block = line.field("content", |text| decoded(text.as_bytes()))?;
        if crc32(&block.0) == expected {
            Ok(block)
        } else {
            Err(wrong(name))
        }
    }
}

/// A block's bytes from its characters; `None` unless they would be written so.
// Written here, and not with a library's code: that is three times as long on a board.
#[inline(never)]
fn decoded(content: &[u8]) -> Option<Block> {
    if content.len() != CONTENT {
        return None;
    }
    let mut block = Block::ERASED;
    let mut bytes = block.0.iter_mut();
    let (mut bits, mut count) = (0_u32, 0);
    for &character in content {
        let value = match character {
            b'A'..=b'Z' => character - b'A',
            b'a'..=b'z' => character - b'a' + 26,
            b'0'..=b'9' => character - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            *bytes.next()? = (bits >> count) as u8;
            bits &= (1 << count) - 1;
        }
    }
    (bits == 0).then_some(block)
}

/// Writes a block's characters.
fn encode(block: &Block, text: &mut impl fmt::Write) -> fmt::Result {
    let mut bytes = block.0.iter();
    let (mut bits, mut count) = (0_u32, 0);
    for _ in 0..CONTENT {
        if count < 6 {
            // Zeros behind the last byte.
            bits = bits << 8 | u32::from(bytes.next().copied().unwrap_or(0));
            count += 8;
        }
        count -= 6;
        let value = (bits >> count) as usize % ALPHABET.len();
        bits &= (1 << count) - 1;
        text.write_char(char::from(ALPHABET[value]))?;
    }
    Ok(())
}
