//! The exchange of a model on the line: see [`installation`](crate::installation).
//!
//! ```text
//! "INSTALL," length "," crc                 begins, or goes on with a file of so many bytes with this CRC-32
//! "BLOCK," number "," crc "," content       a block of it, with a CRC-32 of its own
//! content = the 64 bytes in Base64, 86 characters, without padding; ones behind the end of the file
//! crc     = eight lower-case hexadecimal digits
//! ```
//!
//! Both are answered with the number of the block that is missing next, or with `done`.

use core::fmt::{self, Write as _};

use super::number;
use crate::checksum::crc32;
use crate::installation::{BLOCK_BYTES, Block, Progress, Transfer};

/// Characters of a block's content: six bits each, the last two of the last one are zeros.
const CONTENT: usize = (BLOCK_BYTES * 8).div_ceil(6);
const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Why the arguments are none.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Wrong {
    /// Not written so.
    Arguments,
    /// The block's own checksum.
    Block,
}

/// Reads `length,crc`.
pub(super) fn transfer(arguments: &str) -> Option<Transfer> {
    let (length, checksum) = arguments.split_once(',')?;
    Some(Transfer {
        length: number(length, "length").ok()?,
        checksum: digits(checksum)?,
    })
}

/// Reads `number,crc,content`.
pub(super) fn block(arguments: &str) -> Result<(u32, Block), Wrong> {
    let parts = || {
        let (place, rest) = arguments.split_once(',')?;
        let (checksum, content) = rest.split_once(',')?;
        let place = number(place, "block").ok()?;
        Some((place, digits(checksum)?, decoded(content.as_bytes())?))
    };
    let (place, expected, block) = parts().ok_or(Wrong::Arguments)?;
    if crc32(&block.0) != expected {
        return Err(Wrong::Block);
    }
    Ok((place, block))
}

/// A block's bytes from its characters; none if it would not be written so.
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
fn encode(block: &Block, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        formatter.write_char(char::from(ALPHABET[value]))?;
    }
    Ok(())
}

/// Eight lower-case hexadecimal digits.
fn digits(text: &str) -> Option<u32> {
    let is_digit = |byte: u8| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
    if text.len() != 8 || !text.bytes().all(is_digit) {
        return None;
    }
    u32::from_str_radix(text, 16).ok()
}

/// `length,crc`, as on the line.
pub(super) struct Begun(pub(super) Transfer);

impl fmt::Display for Begun {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Transfer { length, checksum } = self.0;
        write!(formatter, "{length},{checksum:08x}")
    }
}

/// `number,crc,content`, as on the line.
pub(super) struct Numbered<'b>(pub(super) u32, pub(super) &'b Block);

impl fmt::Display for Numbered<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{},{:08x},", self.0, crc32(&self.1.0))?;
        encode(self.1, formatter)
    }
}

/// What is missing, as on the line.
pub(super) struct Missing(pub(super) Progress);

impl fmt::Display for Missing {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Progress::Next(block) => write!(formatter, "{block}"),
            Progress::Installed => formatter.write_str("done"),
        }
    }
}

/// Reads what [`Missing`] writes.
pub(super) fn progress(text: &str) -> Option<Progress> {
    match text {
        "done" => Some(Progress::Installed),
        _ => number(text, "block").ok().map(Progress::Next),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{format, string::ToString};

    #[test]
    fn a_block_is_written_and_read_back_and_a_damaged_one_refused() {
        let block = Block(core::array::from_fn(|place| (7 * place) as u8));
        let text = Numbered(1355, &block).to_string();
        assert_eq!(text.len(), 4 + 1 + 8 + 1 + 86);
        assert_eq!(super::block(&text), Ok((1355, block)));
        // Two bits that the line's checksum does not see.
        let mut bytes = text.clone().into_bytes();
        bytes[20] ^= 1;
        bytes[30] ^= 1;
        let damaged = alloc::string::String::from_utf8(bytes).unwrap();
        assert_ne!(super::block(&damaged), Ok((1355, block)));
        let wrong = text.replace("1355,", "1355,0");
        assert_eq!(super::block(&wrong), Err(Wrong::Arguments));
        for wrong in [
            &text[..text.len() - 1],
            &format!("{text}A"),
            &format!("{text}=="),
            &text.to_uppercase(),
            &format!("0{text}"),
            "1,2,3",
            "",
        ] {
            assert_eq!(super::block(wrong), Err(Wrong::Arguments), "{wrong}");
        }
        let other = Numbered(1355, &Block::ERASED).to_string();
        let mixed = format!("{}{}", &text[..14], &other[14..]);
        assert_eq!(super::block(&mixed), Err(Wrong::Block));
    }

    #[test]
    fn characters_are_those_of_base64() {
        let block = Block(core::array::from_fn(|place| (7 * place) as u8));
        // Python: base64.b64encode(bytes(7 * place % 256 for place in range(64))).
        let expected = "AAcOFRwjKjE4P0ZNVFtiaXB3foWMk5qhqK+2vcTL0tng5+71/AMKERgfJi00O0JJUFdeZWxzeoGIj5adpKuyuQ==";
        let text = Numbered(0, &block).to_string();
        let (_, content) = text.rsplit_once(',').unwrap();
        assert_eq!(content, expected.trim_end_matches('='));
    }

    #[test]
    fn a_transfer_is_written_and_read_back() {
        let of = Transfer {
            length: 86_729,
            checksum: 0x0f3a_0c11,
        };
        let text = Begun(of).to_string();
        assert_eq!(text, "86729,0f3a0c11");
        assert_eq!(transfer(&text), Some(of));
        for wrong in [
            "86729",
            "086729,0f3a0c11",
            "1,0F3A0C11",
            "1,f3a0c11",
            "1,+f3a0c11",
            ",",
            "",
        ] {
            assert_eq!(transfer(wrong), None, "{wrong}");
        }
        for progress in [Progress::Next(0), Progress::Next(1355), Progress::Installed] {
            assert_eq!(
                super::progress(&Missing(progress).to_string()),
                Some(progress)
            );
        }
        assert_eq!(super::progress("-"), None);
    }
}
