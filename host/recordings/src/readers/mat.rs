//! Numeric matrices of MATLAB 5 files (`.mat`, saved with `-v6` or `-v7`).
//!
//! The format is parsed by hand for the same reasons as npy; anything but real numeric matrices (text, cells,
//! structures, objects) is skipped. Source: MathWorks, *MAT-File Format*, level 5.

use std::io::Read as _;

use flate2::read::ZlibDecoder;

use super::error::Damage;
use super::error::excerpt::excerpt;
use super::npy::Array;
use execution::bounded_read::RECORDING;

const _: () = assert!(RECORDING == 128 << 20, "as an error says");

/// Bytes of the head: text, place of subsystem data, version and byte order.
const HEAD: usize = 128;
/// Type numbers of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of numeric matrices: double, single and integers.
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;
/// Flag of a complex matrix.
const COMPLEX: u8 = 0x08;

/// Fault of a file that is not as MATLAB writes it.
pub(crate) fn fault(what: &str) -> String {
    format!("expected a MATLAB 5 file, but {}", excerpt(what))
}

fn bad(byte: usize, what: &str) -> Damage {
    Damage::at_byte(byte as u64, fault(what))
}

/// The real numeric matrices of two axes in the bytes of a file, in their order; `descr` of each is its variable.
///
/// # Errors
/// Damage with the byte of the fault. Unpacked variables take at most the bound of a file; their elements become numbers of 8 bytes.
pub fn parse(bytes: &[u8]) -> Result<Vec<Array>, Damage> {
    match bytes.get(124..HEAD) {
        Some([0, 1, b'I', b'M']) => {}
        Some([0, 2, b'I', b'M']) => {
            return Err(bad(124, "it has version 7.3 (HDF5): save it with -v7"));
        }
        Some([_, _, b'M', b'I']) => return Err(bad(126, "its numbers are big-endian")),
        _ => return Err(bad(bytes.len().min(124), "its head is missing")),
    }
    let mut matrices = Vec::new();
    // A few kilobytes of zlib can hold gigabytes of zeros, and a file many such variables.
    let mut room = RECORDING;
    let mut file = Elements { bytes, at: HEAD };
    while let Some(byte) = file.more() {
        let element = file
            .next()
            .ok_or_else(|| bad(byte, "it ends in a variable"))?;
        let unpacked;
        let element = if element.kind == COMPRESSED {
            unpacked = unpack(element.data, room).map_err(|what| bad(byte, what))?;
            room -= unpacked.len() as u64;
            let mut inner = Elements {
                bytes: &unpacked,
                at: 0,
            };
            inner
                .next()
                .ok_or_else(|| bad(byte, "it ends in a compressed variable"))?
        } else {
            element
        };
        if element.kind == MATRIX {
            let found = matrix(element.data, byte as u64);
            matrices.extend(found.map_err(|what| bad(byte, what))?);
        }
    }
    Ok(matrices)
}

/// The content of a compressed element, of at most `room` bytes.
fn unpack(data: &[u8], room: u64) -> Result<Vec<u8>, &'static str> {
    let mut unpacked = Vec::new();
    let mut decoder = ZlibDecoder::new(data).take(room + 1);
    let read = decoder.read_to_end(&mut unpacked);
    read.map_err(|_| "its compressed data are damaged")?;
    if unpacked.len() as u64 > room {
        return Err("its variables have more than 128 MiB when they are unpacked");
    }
    Ok(unpacked)
}

/// One element: type and content.
struct Element<'b> {
    kind: u32,
    data: &'b [u8],
}

/// Reader of elements one after another.
struct Elements<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Elements<'b> {
    /// Position of the next element, if there is one.
    fn more(&self) -> Option<usize> {
        (self.at < self.bytes.len()).then_some(self.at)
    }

    /// The next element; none at the end, or where the element is cut.
    fn next(&mut self) -> Option<Element<'b>> {
        let word = |at: usize| {
            let bytes = self.bytes.get(at..at.checked_add(4)?)?;
            Some(u32::from_le_bytes(bytes.try_into().ok()?))
        };
        let tag = word(self.at)?;
        // Up to four bytes fit in the tag itself: type and length share its first word.
        let (kind, start, length) = if tag >> 16 == 0 {
            (tag, self.at + 8, word(self.at + 4)? as usize)
        } else {
            (tag & 0xffff, self.at + 4, (tag >> 16) as usize)
        };
        let data = self.bytes.get(start..start.checked_add(length)?)?;
        // Multiples of 8 bytes from the element's own start: compressed ones before it have any length.
        self.at = match kind {
            COMPRESSED => start + length,
            _ => self.at + (start + length - self.at).next_multiple_of(8),
        };
        Some(Element { kind, data })
    }
}

/// A matrix of the content of its element; none if it is no real numeric one of two axes.
fn matrix(data: &[u8], byte: u64) -> Result<Option<Array>, &'static str> {
    let mut parts = Elements { bytes: data, at: 0 };
    let mut part = || parts.next().ok_or("it ends in the head of a variable");
    let flags = part()?.data;
    let (&class, &kind) = (flags.first().zip(flags.get(1))).ok_or("a variable has no class")?;
    if !NUMERIC.contains(&class) || kind & COMPLEX != 0 {
        return Ok(None);
    }
    let axes = part()?.data;
    let name = String::from_utf8_lossy(part()?.data).into_owned();
    let axis = |at: usize| {
        let bytes = axes.get(4 * at..4 * at + 4)?.try_into().ok()?;
        usize::try_from(i32::from_le_bytes(bytes)).ok()
    };
    let (8, Some(rows), Some(columns)) = (axes.len(), axis(0), axis(1)) else {
        return Ok(None);
    };
    let content = part()?;
    let values = numbers(&content).ok_or("a matrix has elements of an unknown type")?;
    if rows.checked_mul(columns) != Some(values.len()) {
        return Err("a matrix has another number of elements than its shape");
    }
    let shape = [rows, columns];
    Ok(Some(Array::of_variable(name, byte, shape, values)))
}

/// Numbers of an element, whichever type they were packed in: whole ones are saved as small integers.
fn numbers(element: &Element<'_>) -> Option<Vec<f64>> {
    fn all<const N: usize>(data: &[u8], value: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let (chunks, _) = data.as_chunks::<N>();
        chunks.iter().map(|&chunk| value(chunk)).collect()
    }
    let data = element.data;
    Some(match element.kind {
        1 => all(data, |b: [u8; 1]| f64::from(i8::from_le_bytes(b))),
        2 => all(data, |b: [u8; 1]| f64::from(u8::from_le_bytes(b))),
        3 => all(data, |b| f64::from(i16::from_le_bytes(b))),
        4 => all(data, |b| f64::from(u16::from_le_bytes(b))),
        5 => all(data, |b| f64::from(i32::from_le_bytes(b))),
        6 => all(data, |b| f64::from(u32::from_le_bytes(b))),
        7 => all(data, |b| f64::from(f32::from_le_bytes(b))),
        9 => all(data, f64::from_le_bytes),
        12 => all(data, |b| i64::from_le_bytes(b) as f64),
        13 => all(data, |b| u64::from_le_bytes(b) as f64),
        _ => return None,
    })
}

#[cfg(any(test, feature = "testing"))]
pub mod fixture;

#[cfg(test)]
mod tests {
    use super::fixture::{compressed, doubles, file, variable};
    use super::*;
    use crate::readers::npy::Values;

    #[test]
    fn matrices_are_read_packed_or_not() {
        let plain = doubles("data", [2, 3], &[1.0, 4.0, 2.0, 5.0, 3.0, -0.5]);
        let small = variable("pulse", [3, 1], 6, 1, &[0, 100, 0x80]);
        let text = variable("note", [1, 2], 4, 4, &[65, 0, 66, 0]);
        let bytes = file(&[compressed(&plain), text, compressed(&small), plain]);
        let found = parse(&bytes).unwrap();
        let names: Vec<_> = found.iter().map(|own| own.descr.as_str()).collect();
        assert_eq!(names, ["data", "pulse", "data"]);
        let rows = [1.0, 2.0, 3.0, 4.0, 5.0, -0.5];
        assert_eq!(found[0].values, Values::Numbers(rows.into()));
        let pulse = [0.0, 100.0, -128.0];
        assert_eq!(found[1].values, Values::Numbers(pulse.into()));
        assert_eq!(found[0].byte_of_row(1), 128);
        assert_eq!(found[0].shape, [2, 3]);
        assert_eq!(found[2].values, found[0].values);
    }

    #[test]
    fn other_versions_and_wrong_shapes_say_so() {
        let mut newer = file(&[]);
        newer[125] = 2;
        let error = parse(&newer).unwrap_err().fault;
        assert!(error.contains("-v7"), "{error}");
        let wrong = file(&[doubles("data", [2, 2], &[1.0; 3])]);
        let error = parse(&wrong).unwrap_err().fault;
        assert!(error.contains("shape"), "{error}");
        assert!(parse(b"MATLAB 5.0 MAT-file").is_err());
    }

    #[test]
    fn every_cut_is_refused_or_ends_between_variables() {
        let one = compressed(&doubles("data", [2, 2], &[1.0, 2.0, 3.0, 4.0]));
        let bytes = file(&[one.clone(), one.clone()]);
        for end in 0..bytes.len() {
            let between = end == HEAD || end == HEAD + one.len();
            assert_eq!(parse(&bytes[..end]).is_ok(), between, "{end}");
        }
    }

    #[test]
    fn many_small_variables_do_not_unpack_without_end_either() {
        // 16 MiB of zeros each, together more than a file may have.
        let axis = 16 << 20;
        let zeros = vec![0; axis];
        let variable = compressed(&variable("data", [axis as i32, 1], 8, 1, &zeros));
        let bytes = file(&vec![variable; 9]);
        assert!(bytes.len() < 1 << 20);
        let fault = parse(&bytes).err().map(|error| error.fault);
        assert!(fault.is_some_and(|fault| fault.contains("unpacked")));
    }
}
