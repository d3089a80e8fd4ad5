//! The beginning of a text in another encoding, to tell what it would be.

/// Bytes that are decoded.
const BEGINNING: usize = 8192;

/// Beginning of a UTF-16 text, with or without a byte order mark.
pub(crate) fn of_utf16(bytes: &[u8]) -> String {
    // Without a mark: the first character of every text format here is ASCII.
    let is_big = matches!(bytes, [0xfe, 0xff, ..] | [0, _, ..]);
    let (units, _) = bytes[..bytes.len().min(BEGINNING)].as_chunks::<2>();
    let read = if is_big {
        u16::from_be_bytes
    } else {
        u16::from_le_bytes
    };
    let units: Vec<u16> = units.iter().map(|&unit| read(unit)).collect();
    let text = String::from_utf16_lossy(&units);
    text.trim_start_matches('\u{feff}').to_owned()
}

/// Beginning of a text that is UTF-8 but for some characters.
pub(crate) fn of_utf8(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(BEGINNING)]).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_are_decoded() {
        for bytes in [
            &b"\xff\xfe1\0,\0"[..],
            b"1\0,\0",
            b"\x001\x00,",
            b"\xfe\xff\x001\x00,",
        ] {
            assert_eq!(of_utf16(bytes), "1,", "{bytes:?}");
        }
    }
}
