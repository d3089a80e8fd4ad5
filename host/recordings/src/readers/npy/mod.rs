//! Arrays as numpy saves them (`.npy`), numbers or text.
//!
//! A damaged file gives a place and a reason, never a panic or an allocation beyond its own length, and the labels of
//! `roshambo` are text (`|S7` and `<U7`). The crate `npyz` 0.9.1 promises neither: it multiplies the axes of a header
//! unchecked, allocates what a `descr` claims, and each bracket in a header doubles its time (18 of them: 8 s).
//! Source: NEP 1, *A Simple File Format for NumPy Arrays*.

mod header;

use std::path::Path;

use super::error::excerpt::excerpt;
use super::error::{Damage, LoadError};
use header::NpyHeader;

const MAGIC: &[u8] = b"\x93NUMPY";

/// An array. Its elements are in C order (first axis slowest), whatever the order in the file.
#[derive(Clone, PartialEq, Debug)]
pub struct Array {
    /// Length of each axis; empty for a single value.
    pub shape: Vec<usize>,
    /// Element type as numpy writes it: `<i8` is int64, `|S7` seven bytes of text; of a MATLAB file the variable's name.
    pub descr: String,
    /// The elements.
    pub values: Values,
    /// Byte of the first element.
    start: u64,
    /// Bytes from the first element of a row to that of the next.
    row_bytes: usize,
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
    /// Reorders elements from column after column to row after row.
    fn by_row(self, columns: usize) -> Self {
        fn transposed<T: Clone>(values: &[T], columns: usize) -> Vec<T> {
            let rows = values.len() / columns.max(1);
            (0..values.len())
                .map(|i| values[i % columns * rows + i / columns].clone())
                .collect()
        }
        match self {
            // Both orders are the same.
            values if columns == 1 => values,
            Self::Numbers(values) => Self::Numbers(transposed(&values, columns)),
            Self::Text(values) => Self::Text(transposed(&values, columns)),
        }
    }
}

impl Array {
    /// Matrix of a MATLAB file: its variable, the byte where that starts, and the elements column after column.
    pub(super) fn of_variable(
        name: String,
        start: u64,
        shape: [usize; 2],
        values: Vec<f64>,
    ) -> Self {
        Self {
            values: Values::Numbers(values).by_row(shape[1]),
            shape: shape.into(),
            descr: name,
            start,
            row_bytes: 0,
        }
    }

    /// Byte of the file at which a row (along the first axis) starts.
    pub const fn byte_of_row(&self, row: usize) -> u64 {
        self.start + (row * self.row_bytes) as u64
    }

    /// Shape and type for a message: `(8990, 8) of <i8`.
    pub fn describe(&self) -> String {
        format!("({}) of {}", axes(&self.shape), self.descr)
    }
}

/// Lengths of axes as text: `8990, 8`.
fn axes(shape: &[usize]) -> String {
    format!("{shape:?}").replace(['[', ']'], "")
}

/// Reads a whole npy file.
///
/// # Errors
/// [`LoadError::Io`], or [`LoadError::Damaged`] with the byte of the fault.
pub fn read(path: &Path) -> Result<Array, LoadError> {
    parse(&super::read(path)?).map_err(|damage| damage.in_file(path))
}

/// Parses the bytes of an npy file.
///
/// # Errors
/// Damage with the byte of the fault: no npy file, an element type or order that is not read here, or another length
/// than the header requires.
pub fn parse(bytes: &[u8]) -> Result<Array, Damage> {
    elements(NpyHeader::parse(bytes)?, bytes)
}

/// Parses rows of integers of two bytes each, without a header.
pub(crate) fn int16(columns: usize, bytes: &[u8]) -> Result<Array, Damage> {
    let header = NpyHeader {
        descr: "<i2".to_owned(),
        by_column: false,
        shape: vec![bytes.len().div_ceil(2 * columns), columns],
        data_start: 0,
    };
    elements(header, bytes)
}

/// Damage of a file that is no array.
fn bad(byte: u64, what: &str) -> Damage {
    let what = excerpt(what);
    Damage::at_byte(
        byte,
        format!("expected an npy file (format 1 to 3), but {what}"),
    )
}

/// Parses the elements behind a header.
fn elements(header: NpyHeader, bytes: &[u8]) -> Result<Array, Damage> {
    let NpyHeader {
        descr,
        by_column,
        shape,
        data_start,
    } = header;
    let (kind, size) = element(&descr)
        .ok_or_else(|| bad(10, &format!("elements of type {descr} are not read here")))?;

    let data = &bytes[data_start..];
    let expected = shape
        .iter()
        .try_fold(size, |product, &axis| product.checked_mul(axis));
    if expected != Some(data.len()) {
        let expected = expected.map_or(u64::MAX, |n| data_start.saturating_add(n) as u64);
        let found = bytes.len() as u64;
        let fault =
            format!("expected {expected} bytes, found {found}: the file is cut short or damaged");
        return Err(Damage::at_byte(found, fault));
    }
    // Bounded by the file's length, but for the rows of an array without any.
    let columns = shape
        .iter()
        .skip(1)
        .fold(1_usize, |product, &axis| product.saturating_mul(axis));
    if by_column && shape.len() > 2 {
        return Err(bad(10, "more than two axes are read in C order only"));
    }
    let elements = data.chunks_exact(size);
    let values = match kind {
        'S' => Values::Text(elements.map(ascii).collect()),
        'U' => Values::Text(elements.map(utf32).collect()),
        _ => Values::Numbers(elements.map(|bytes| number(kind, bytes)).collect()),
    };
    let (values, row_bytes) = if by_column {
        (values.by_row(columns), size)
    } else {
        (values, size.saturating_mul(columns))
    };
    Ok(Array {
        values,
        shape,
        descr,
        start: data_start as u64,
        row_bytes,
    })
}

/// Kind and bytes of an element of a `descr`; none if it is not read here.
fn element(descr: &str) -> Option<(char, usize)> {
    let (order, rest) = descr.split_at_checked(1)?;
    let kind = rest.chars().next()?;
    let size: usize = rest[kind.len_utf8()..].parse().ok()?;
    // Big-endian elements (`>`) appear in none of the sets; single bytes carry `|`.
    let is_read = matches!(
        (kind, size),
        ('i' | 'u', 1 | 2 | 4 | 8) | ('b', 1) | ('f', 4 | 8) | ('S' | 'U', 1..=1024)
    );
    let bytes = if kind == 'U' { 4 * size } else { size };
    (is_read && matches!(order, "<" | "|")).then_some((kind, bytes))
}

/// Value of a numeric element of up to 8 bytes.
fn number(kind: char, element: &[u8]) -> f64 {
    let mut bytes = [0; 8];
    bytes[..element.len()].copy_from_slice(element);
    let word = u64::from_le_bytes(bytes);
    match (kind, element.len()) {
        ('f', 4) => f64::from(f32::from_bits(word as u32)),
        ('f', _) => f64::from_bits(word),
        ('i', size) => {
            let unused = 64 - 8 * size as u32;
            ((word << unused) as i64 >> unused) as f64
        }
        _ => word as f64,
    }
}

/// Text of an element of bytes, padding removed.
fn ascii(element: &[u8]) -> String {
    String::from_utf8_lossy(element)
        .trim_end_matches('\0')
        .to_owned()
}

/// Text of an element of UTF-32 code points, padding removed.
fn utf32(element: &[u8]) -> String {
    let (codes, _) = element.as_chunks::<4>();
    let codes = codes.iter().map(|&code| u32::from_le_bytes(code));
    let letters = codes.take_while(|&code| code != 0);
    letters
        .map(|code| char::from_u32(code).unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}

/// The bytes of an npy file in C order; `data` holds the elements in the type `descr`.
pub fn encode(descr: &str, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let mut bytes = NpyHeader::encode(descr, shape);
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(descr: &str, count: usize, data: &[u8]) -> Values {
        parse(&encode(descr, &[count], data)).unwrap().values
    }

    #[test]
    fn integers_keep_their_sign_at_every_size() {
        let array = parse(&encode("|i1", &[2, 2], &[0x80, 0x7f, 0xff, 0])).unwrap();
        let expected = Values::Numbers(vec![-128.0, 127.0, -1.0, 0.0]);
        assert_eq!((array.values, array.shape), (expected, vec![2, 2]));
        let number = |value| Values::Numbers(vec![value]);
        assert_eq!(values("<i8", 1, &(-5i64).to_le_bytes()), number(-5.0));
        assert_eq!(values("<f4", 1, &0.5f32.to_le_bytes()), number(0.5));
    }

    #[test]
    fn fortran_order_is_transposed() {
        let mut bytes = encode("|i1", &[2, 3], &[1, 4, 2, 5, 3, 6]);
        let at = bytes.windows(5).position(|part| part == b"False").unwrap();
        bytes[at..at + 5].copy_from_slice(b"True ");
        let array = parse(&bytes).unwrap();
        let expected = [1, 2, 3, 4, 5, 6].map(f64::from);
        assert_eq!(array.values, Values::Numbers(expected.into()));
        assert_eq!(array.byte_of_row(1), bytes.len() as u64 - 5);
    }

    #[test]
    fn text_comes_in_both_widths() {
        let expected = Values::Text(vec!["rock".into(), "none".into()]);
        assert_eq!(values("|S7", 2, b"rock\0\0\0none\0\0\0"), expected);
        let wide = "rock\0\0none\0\0".chars();
        let wide: Vec<u8> = wide.flat_map(|c| (c as u32).to_le_bytes()).collect();
        assert_eq!(values("<U6", 2, &wide), expected);
    }

    #[test]
    fn a_cut_file_says_how_many_bytes_are_missing() {
        let whole = encode("<i8", &[2, 8], &[0; 128]);
        let damage = parse(&whole[..whole.len() - 3]).unwrap_err();
        let words = "byte 253: expected 256 bytes, found 253";
        assert!(damage.to_string().starts_with(words), "{damage}");
    }

    #[test]
    fn sizes_beyond_memory_and_foreign_types_are_refused() {
        assert!(parse(&encode("<i8", &[usize::MAX, 9], &[])).is_err());
        assert!(parse(&encode("|i1", &[usize::MAX], &[])).is_err());
        assert!(parse(&encode("<i8", &[0, usize::MAX, 9], &[])).is_ok());
        assert!(parse(&encode("|O", &[1], &[0; 8])).is_err());
        assert!(parse(b"\x93NUMPY\x09\x00").is_err());
    }

    #[test]
    fn an_encoded_header_is_the_one_that_numpy_writes() {
        // As in `subject02_session01_emg.npy` of the published recordings.
        let dictionary = "{'descr': '<i8', 'fortran_order': False, 'shape': (SHAPE), }";
        for (shape, text) in [(&[8990, 8][..], "8990, 8"), (&[8990], "8990,")] {
            let bytes = encode("<i8", shape, &[]);
            assert_eq!(bytes[..10], *b"\x93NUMPY\x01\x00\x76\x00");
            let header = std::str::from_utf8(&bytes[10..]).unwrap();
            assert_eq!((bytes.len(), &header[117..]), (128, "\n"));
            assert_eq!(header.trim_end(), dictionary.replace("SHAPE", text));
        }
    }
}
