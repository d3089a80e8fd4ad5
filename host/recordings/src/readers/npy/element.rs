//! Element types of an npy file.

/// An element type that is read here.
pub(super) enum Element {
    Number(Number),
    Ascii(usize),
    Utf32(usize),
}

/// A numeric type of up to 8 bytes.
#[derive(Clone, Copy)]
pub(super) enum Number {
    Signed(usize),
    Unsigned(usize),
    F32,
    F64,
}

impl Element {
    /// The type of a `descr`; none if it is not read here.
    pub fn parse(descr: &str) -> Option<Self> {
        let (order, rest) = descr.split_at_checked(1)?;
        let (kind, size) = rest.split_at_checked(1)?;
        let size: usize = size.parse().ok()?;
        // Big-endian elements (`>`) appear in none of the sets; single bytes carry `|`.
        if !(order == "<" || order == "|") {
            return None;
        }
        Some(match (kind, size) {
            ("i", 1 | 2 | 4 | 8) => Self::Number(Number::Signed(size)),
            ("u", 1 | 2 | 4 | 8) => Self::Number(Number::Unsigned(size)),
            ("b", 1) => Self::Number(Number::Unsigned(1)),
            ("f", 4) => Self::Number(Number::F32),
            ("f", 8) => Self::Number(Number::F64),
            ("S", 1..=1024) => Self::Ascii(size),
            ("U", 1..=1024) => Self::Utf32(size),
            _ => return None,
        })
    }

    /// Bytes of one element.
    pub const fn bytes(&self) -> usize {
        match self {
            Self::Number(Number::Signed(size) | Number::Unsigned(size)) | Self::Ascii(size) => {
                *size
            }
            Self::Number(Number::F32) => 4,
            Self::Number(Number::F64) => 8,
            Self::Utf32(length) => 4 * *length,
        }
    }
}

impl Number {
    /// The value of one element of exactly this number's bytes.
    pub fn value(self, element: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        bytes[..element.len()].copy_from_slice(element);
        let word = u64::from_le_bytes(bytes);
        match self {
            Self::Unsigned(_) => word as f64,
            Self::Signed(size) => {
                let unused = 64 - 8 * size as u32;
                ((word << unused) as i64 >> unused) as f64
            }
            Self::F32 => f64::from(f32::from_bits(word as u32)),
            Self::F64 => f64::from_bits(word),
        }
    }
}

/// Text of an element of bytes, padding removed.
pub(super) fn ascii(element: &[u8]) -> String {
    String::from_utf8_lossy(element)
        .trim_end_matches('\0')
        .to_owned()
}

/// Text of an element of UTF-32 code points, padding removed.
pub(super) fn utf32(element: &[u8]) -> String {
    element
        .chunks_exact(4)
        .map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]))
        .take_while(|&code| code != 0)
        .map(|code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}
