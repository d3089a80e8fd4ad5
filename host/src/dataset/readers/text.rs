//! Bytes as text.

/// What the bytes of a file are.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Text<'b> {
    /// UTF-8, a byte order mark left out.
    Utf8(&'b str),
    /// The beginning of a UTF-16 text, for recognising what it would be.
    Utf16(String),
    /// No text.
    Binary,
}

/// Bytes of a UTF-16 text that are decoded.
const BEGINNING: usize = 8192;

impl<'b> Text<'b> {
    pub fn of(bytes: &'b [u8]) -> Self {
        let big = match bytes {
            [0xff, 0xfe, ..] => Some(false),
            [0xfe, 0xff, ..] => Some(true),
            // Without a mark: the first character of every text format here is ASCII.
            [first, 0, second, 0, ..] if *first != 0 && *second != 0 => Some(false),
            [0, first, 0, second, ..] if *first != 0 && *second != 0 => Some(true),
            _ => None,
        };
        if let Some(big) = big {
            let (units, _) = bytes[..bytes.len().min(BEGINNING)].as_chunks::<2>();
            let units: Vec<u16> = units
                .iter()
                .map(|&unit| {
                    if big {
                        u16::from_be_bytes(unit)
                    } else {
                        u16::from_le_bytes(unit)
                    }
                })
                .collect();
            let text = String::from_utf16_lossy(&units);
            return Self::Utf16(text.trim_start_matches('\u{feff}').to_owned());
        }
        match std::str::from_utf8(bytes) {
            Ok(text) => Self::Utf8(text.strip_prefix('\u{feff}').unwrap_or(text)),
            Err(_) => Self::Binary,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_told_apart() {
        assert_eq!(Text::of(b"1,2"), Text::Utf8("1,2"));
        assert_eq!(Text::of(b"\xef\xbb\xbf1,2"), Text::Utf8("1,2"));
        for bytes in [
            &b"\xff\xfe1\0,\0"[..],
            b"1\0,\0",
            b"\x001\x00,",
            b"\xfe\xff\x001\x00,",
        ] {
            assert_eq!(Text::of(bytes), Text::Utf16("1,".into()), "{bytes:?}");
        }
        assert_eq!(Text::of(b"\xff\x00\x01"), Text::Binary);
        assert_eq!(Text::of(b""), Text::Utf8(""));
    }
}
