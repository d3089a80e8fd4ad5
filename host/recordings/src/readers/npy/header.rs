//! The header of an npy file: a Python dictionary as text, parsed by hand.

use super::{MAGIC, bad};
use crate::readers::error::Damage;

/// Content of the header.
pub(super) struct NpyHeader {
    /// Element type as numpy writes it.
    pub descr: String,
    /// Whether the first axis is the fastest (Fortran order).
    pub by_column: bool,
    /// Length of each axis.
    pub shape: Vec<usize>,
    /// Byte of the first element.
    pub data_start: usize,
}

impl NpyHeader {
    /// Parses the header that a file starts with.
    pub fn parse(bytes: &[u8]) -> Result<Self, Damage> {
        let (text, data_start) = text(bytes)?;
        let descr =
            quoted(&text, "'descr':").ok_or_else(|| bad(10, "its header has no 'descr'"))?;
        let shape = shape(&text).ok_or_else(|| bad(10, "its header has no readable 'shape'"))?;
        Ok(Self {
            descr: descr.to_owned(),
            by_column: after(&text, "'fortran_order':")
                .is_some_and(|rest| rest.starts_with("True")),
            shape,
            data_start,
        })
    }

    /// The header of C order, padded with spaces so that the elements start at a multiple of 64 bytes.
    pub fn encode(descr: &str, shape: &[usize]) -> Vec<u8> {
        let axes = super::axes(shape);
        // A tuple of one element in Python: `(600,)`.
        let comma = if shape.len() == 1 { "," } else { "" };
        let text =
            format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({axes}{comma}), }}");
        let end = (START_V1 + text.len() + 1).next_multiple_of(ALIGNMENT);
        let padded = end - START_V1;
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((padded as u16).to_le_bytes());
        bytes.extend(format!("{text:<width$}\n", width = padded - 1).as_bytes());
        bytes
    }
}

/// Byte at which the text of a header of version 1 starts.
const START_V1: usize = 10;
/// Alignment of the elements in a file, in bytes, which the format requires.
const ALIGNMENT: usize = 64;

/// The dictionary's text, and where the data starts. Both are bounded by the file's end, whatever length the header
/// claims.
fn text(bytes: &[u8]) -> Result<(String, usize), Damage> {
    if !bytes.starts_with(MAGIC) {
        return Err(bad(0, "it does not start with the npy magic"));
    }
    let (start, length) = match bytes.get(6..12) {
        Some(&[1, _, a, b, ..]) => (START_V1, usize::from(u16::from_le_bytes([a, b]))),
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
