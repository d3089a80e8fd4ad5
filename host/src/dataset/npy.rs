//! Arrays as numpy saves them (`.npy`), numbers or text.
//!
//! Reads the header by hand: a damaged file must give a place and a reason, never a panic, and the
//! labels of `roshambo` are text (`|S7` and `<U7`), which few readers know.
//! Source: NEP 1, *A Simple File Format for NumPy Arrays*.

use super::error::{Damage, Fault};

const MAGIC: &[u8] = b"\x93NUMPY";

/// An array, elements with the first axis slowest, however the file has them.
#[derive(Clone, PartialEq, Debug)]
pub struct Array {
    /// Length of each axis; empty for a single value.
    pub shape: Vec<usize>,
    /// Element type as numpy writes it: `<i8` is int64, `|S7` seven bytes of text.
    pub descr: String,
    /// The elements.
    pub values: Values,
    /// Where elements lie in the file.
    pub layout: Layout,
}

/// Where the elements of an [`Array`] lie in its file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Layout {
    /// Byte of the first element.
    pub start: u64,
    /// Bytes from the first element of a row to that of the next.
    pub row_bytes: usize,
}

/// Elements of an [`Array`].
#[derive(Clone, PartialEq, Debug)]
pub enum Values {
    /// Integers, truth values and floats of up to 8 bytes.
    Numbers(Vec<f64>),
    /// Text, padding removed.
    Text(Vec<String>),
}

impl Values {
    /// Turns elements that stand column after column into row after row.
    fn by_row(self, columns: usize) -> Self {
        fn turned<T: Clone>(values: &[T], columns: usize) -> Vec<T> {
            let rows = values.len() / columns.max(1);
            (0..values.len())
                .map(|i| values[i % columns * rows + i / columns].clone())
                .collect()
        }
        match self {
            Self::Numbers(values) => Self::Numbers(turned(&values, columns)),
            Self::Text(values) => Self::Text(turned(&values, columns)),
        }
    }
}

impl Array {
    /// Byte of the file at which the first element of a row (along the first axis) stands.
    #[must_use]
    pub const fn byte_of_row(&self, row: usize) -> u64 {
        self.layout.start + (row * self.layout.row_bytes) as u64
    }

    /// Shape and type for a message: `(9183, 8) of <i8`.
    #[must_use]
    pub fn describe(&self) -> String {
        let axes: Vec<_> = self.shape.iter().map(ToString::to_string).collect();
        format!("({}) of {}", axes.join(", "), self.descr)
    }
}

/// Whether a file that starts so is an npy file.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Reads a whole npy file from its bytes.
///
/// # Errors
/// With the byte of the fault: no npy file, an element type or order that is not read here, or
/// another length than the header says.
pub(super) fn parse(bytes: &[u8]) -> Result<Array, Damage> {
    let (header, data_start) = header(bytes)?;
    let bad = |what: &str| Damage::at_byte(10, Fault::Npy(what.to_owned()));
    let descr = quoted(&header, "'descr':").ok_or_else(|| bad("its header has no 'descr'"))?;
    let by_column = after(&header, "'fortran_order':").is_some_and(|rest| rest.starts_with("True"));
    let shape = shape(&header).ok_or_else(|| bad("its header has no readable 'shape'"))?;
    let element = Element::parse(descr)
        .ok_or_else(|| bad(&format!("elements of type {descr} are not read here")))?;

    let data = &bytes[data_start..];
    let size = element.bytes();
    let expected = shape
        .iter()
        .try_fold(size, |product, &axis| product.checked_mul(axis));
    if expected != Some(data.len()) {
        let expected = expected.map_or(u64::MAX, |n| data_start.saturating_add(n) as u64);
        let fault = Fault::Length {
            expected,
            found: bytes.len() as u64,
        };
        return Err(Damage::at_byte(bytes.len() as u64, fault));
    }
    // Bounded by the file's length, but for the rows of an array without any.
    let columns = shape
        .iter()
        .skip(1)
        .fold(1_usize, |product, &axis| product.saturating_mul(axis));
    if by_column && shape.len() > 2 {
        return Err(bad("more than two axes are read in C order only"));
    }
    let values = match element {
        Element::Number(kind) => {
            Values::Numbers(data.chunks_exact(size).map(|e| kind.value(e)).collect())
        }
        Element::Ascii(_) => Values::Text(
            data.chunks_exact(size)
                .map(|e| String::from_utf8_lossy(e).trim_end_matches('\0').to_owned())
                .collect(),
        ),
        Element::Utf32(_) => Values::Text(data.chunks_exact(size).map(utf32).collect()),
    };
    let row_bytes = if by_column {
        size
    } else {
        size.saturating_mul(columns)
    };
    Ok(Array {
        values: if by_column {
            values.by_row(columns)
        } else {
            values
        },
        shape,
        descr: descr.to_owned(),
        layout: Layout {
            start: data_start as u64,
            row_bytes,
        },
    })
}

/// The dictionary of the header, and where the data starts.
fn header(bytes: &[u8]) -> Result<(String, usize), Damage> {
    let bad = |byte, what: &str| Damage::at_byte(byte, Fault::Npy(what.to_owned()));
    if !looks_like(bytes) {
        return Err(bad(0, "it does not start with the npy mark"));
    }
    let (start, length) = match bytes.get(6..12) {
        Some(&[1, _, a, b, ..]) => (10_usize, usize::from(u16::from_le_bytes([a, b]))),
        Some(&[2 | 3, _, a, b, c, d]) => (12, u32::from_le_bytes([a, b, c, d]) as usize),
        _ => return Err(bad(6, "its format version is unknown or it ends there")),
    };
    let text = bytes
        .get(start..start.saturating_add(length))
        .ok_or_else(|| bad(bytes.len() as u64, "it ends within its header"))?;
    Ok((String::from_utf8_lossy(text).into_owned(), start + length))
}

fn after<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    header
        .find(key)
        .map(|at| header[at + key.len()..].trim_start())
}

fn quoted<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    after(header, key)?
        .strip_prefix('\'')?
        .split_once('\'')
        .map(|(text, _)| text)
}

fn shape(header: &str) -> Option<Vec<usize>> {
    let (axes, _) = after(header, "'shape':")?
        .strip_prefix('(')?
        .split_once(')')?;
    axes.split(',')
        .map(str::trim)
        .filter(|a| !a.is_empty())
        .map(|a| a.parse().ok())
        .collect()
}

fn utf32(element: &[u8]) -> String {
    element
        .chunks_exact(4)
        .map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]))
        .take_while(|&code| code != 0)
        .map(|code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}

enum Element {
    Number(Number),
    Ascii(usize),
    Utf32(usize),
}

#[derive(Clone, Copy)]
enum Number {
    Signed(usize),
    Unsigned(usize),
    F32,
    F64,
}

impl Element {
    fn parse(descr: &str) -> Option<Self> {
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

    const fn bytes(&self) -> usize {
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
    fn value(self, element: &[u8]) -> f64 {
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

/// The bytes of an npy file, for tests of its readers.
#[cfg(test)]
pub(super) fn file(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_keep_their_sign_at_every_size() {
        let array = parse(&file("|i1", "2, 2", &[0x80, 0x7f, 0xff, 0])).unwrap();
        assert_eq!(
            array.values,
            Values::Numbers(vec![-128.0, 127.0, -1.0, 0.0])
        );
        assert_eq!(array.shape, [2, 2]);
        let array = parse(&file("<i8", "1,", &(-5i64).to_le_bytes())).unwrap();
        assert_eq!(array.values, Values::Numbers(vec![-5.0]));
        let array = parse(&file("<f4", "1,", &0.5f32.to_le_bytes())).unwrap();
        assert_eq!(array.values, Values::Numbers(vec![0.5]));
    }

    #[test]
    fn columns_of_the_other_order_are_turned_into_rows() {
        let mut bytes = file("|i1", "2, 3", &[1, 4, 2, 5, 3, 6]);
        let at = bytes.windows(5).position(|word| word == b"False").unwrap();
        bytes[at..at + 5].copy_from_slice(b"True ");
        let array = parse(&bytes).unwrap();
        assert_eq!(
            array.values,
            Values::Numbers(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
        );
        assert_eq!(array.byte_of_row(1), bytes.len() as u64 - 5);
    }

    #[test]
    fn text_comes_in_both_widths() {
        let expected = Values::Text(vec!["rock".into(), "none".into()]);
        assert_eq!(
            parse(&file("|S7", "2,", b"rock\0\0\0none\0\0\0"))
                .unwrap()
                .values,
            expected
        );
        let wide: Vec<u8> = "rock\0\0none\0\0"
            .chars()
            .flat_map(|c| (c as u32).to_le_bytes())
            .collect();
        assert_eq!(parse(&file("<U6", "2,", &wide)).unwrap().values, expected);
    }

    #[test]
    fn a_cut_file_says_how_many_bytes_are_missing() {
        let whole = file("<i8", "2, 8", &[0; 128]);
        let damage = parse(&whole[..whole.len() - 3]).unwrap_err();
        let expected = whole.len() as u64;
        assert_eq!(
            damage,
            Damage::at_byte(
                expected - 3,
                Fault::Length {
                    expected,
                    found: expected - 3
                }
            )
        );
    }

    #[test]
    fn sizes_beyond_memory_and_foreign_types_are_refused() {
        assert!(parse(&file("<i8", "18446744073709551615, 9", &[])).is_err());
        assert!(parse(&file("|i1", "18446744073709551615,", &[])).is_err());
        assert!(parse(&file("<i8", "0, 18446744073709551615, 9", &[])).is_ok());
        assert!(parse(&file("|O", "1,", &[0; 8])).is_err());
        assert!(parse(b"\x93NUMPY\x09\x00").is_err());
    }

    proptest::proptest! {
        #[test]
        fn arbitrary_bytes_never_panic(head: bool, bytes: Vec<u8>) {
            let mut file = if head { MAGIC.to_vec() } else { Vec::new() };
            file.extend(bytes);
            let _ = parse(&file);
        }
    }
}
