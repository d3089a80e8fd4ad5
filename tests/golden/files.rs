//! Readers of reference files.

use std::fs;
use std::path::Path;

use recordings::npy::{self, Values};
use serde_json::Value;

/// Element type of the reference's npy files.
pub trait Element {
    /// Name of the type in numpy.
    const DESCR: &'static str;
    /// Converts a value, exactly for every value of the type.
    fn from_f64(value: f64) -> Self;
}

macro_rules! elements {
    ($($element:ty = $descr:literal)*) => {
        $(impl Element for $element {
            const DESCR: &'static str = $descr;
            fn from_f64(value: f64) -> Self {
                value as Self
            }
        })*
    };
}

elements!(i8 = "|i1" i16 = "<i2" f32 = "<f4");

/// Reads all values of an npy file, last axis fastest, whichever axis is fastest in the file.
pub fn npy<T: Element>(path: &Path) -> Vec<T> {
    let array = npy::read(path).unwrap_or_else(|error| panic!("{error}"));
    let Values::Numbers(values) = &array.values else {
        panic!("{}: {}", path.display(), array.describe());
    };
    assert_eq!(array.descr, T::DESCR, "{}", path.display());
    values.iter().map(|&value| T::from_f64(value)).collect()
}

pub fn json(path: &Path) -> Value {
    let text =
        fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap()
}

/// FNV-1a of 64 bits, in hexadecimal: it stands for numbers that are not in the repository.
pub fn checksum(bytes: impl Iterator<Item = u8>) -> String {
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// Unrolls run-length labels; -1 is `None`.
pub fn labels(runs: &Value) -> Vec<Option<usize>> {
    let run = |run: &Value| {
        let class = usize::try_from(run[0].as_i64().unwrap()).ok();
        vec![class; run[1].as_u64().unwrap() as usize]
    };
    runs.as_array().unwrap().iter().flat_map(run).collect()
}
