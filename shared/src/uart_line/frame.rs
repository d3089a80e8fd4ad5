//! Frame of a line, its checksum, and numbers as the grammar has them.

use super::ParseError;

/// The body of a line whose frame and checksum are right, CR LF included.
pub(super) fn framed(line: &[u8]) -> Result<&str, ParseError> {
    unframed(line.strip_suffix(b"\r\n").ok_or(ParseError::Frame)?)
}

/// The body of a line without its CR LF.
pub(super) fn unframed(line: &[u8]) -> Result<&str, ParseError> {
    let (body, found) = core::str::from_utf8(line)
        .ok()
        .filter(|text| text.is_ascii())
        .and_then(|text| text.strip_prefix('$')?.rsplit_once('*'))
        .ok_or(ParseError::Frame)?;
    let found = hexadecimal(found.as_bytes(), 2, b'A').ok_or(ParseError::Frame)? as u8;
    let expected = checksum(body);
    if found == expected {
        Ok(body)
    } else {
        Err(ParseError::Checksum { expected, found })
    }
}

/// XOR of the bytes of a body.
pub(super) fn checksum(body: &str) -> u8 {
    body.bytes().fold(0, |sum, byte| sum ^ byte)
}

/// The number that `digits` hexadecimal digits say, whose letters begin with `a` or `A`.
pub(super) fn hexadecimal(text: &[u8], digits: usize, a: u8) -> Option<u32> {
    if text.len() != digits {
        return None;
    }
    text.iter().try_fold(0, |number, &byte| {
        let digit = match byte {
            b'0'..=b'9' => byte - b'0',
            _ if (a..a + 6).contains(&byte) => byte - a + 10,
            _ => return None,
        };
        Some(number << 4 | u32::from(digit))
    })
}

/// The numbers of `digits` upper-case hexadecimal digits each that a text consists of.
pub(super) fn hexadecimals<const N: usize>(text: &str, digits: usize) -> Option<[u32; N]> {
    let mut numbers = [0; N];
    if text.len() != N * digits {
        return None;
    }
    for (number, text) in numbers.iter_mut().zip(text.as_bytes().chunks(digits)) {
        *number = hexadecimal(text, digits, b'A')?;
    }
    Some(numbers)
}

/// A number as it is written: decimal, without leading zeros.
#[inline(never)]
pub(super) fn number(text: &str) -> Option<u32> {
    let is_canonical =
        text.bytes().all(|byte| byte.is_ascii_digit()) && (text == "0" || !text.starts_with('0'));
    text.parse().ok().filter(|_| is_canonical)
}
