//! Reading reference files.

use std::fs;
use std::path::Path;

use npyz::{Deserialize, NpyFile, Order};
use serde_json::Value;

/// All values of an npy file, last axis fastest. Some of the reference's own files say the first
/// axis is: read as they lie, all their samples would be mixed up.
pub fn npy<T: Deserialize + Copy>(path: &Path) -> Vec<T> {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let file = NpyFile::new(&bytes[..]).unwrap();
    let (order, shape) = (file.order(), file.shape().to_vec());
    let values = file.into_vec().unwrap();
    match (order, &shape[..]) {
        (Order::C, _) | (_, [_]) => values,
        (Order::Fortran, [rows, columns]) => {
            let (rows, columns) = (*rows as usize, *columns as usize);
            let place = |index| (index % columns) * rows + index / columns;
            (0..rows * columns)
                .map(|index| values[place(index)])
                .collect()
        }
        (Order::Fortran, shape) => panic!("{}: shape {shape:?}", path.display()),
    }
}

/// A JSON file.
pub fn json(path: &Path) -> Value {
    let text =
        fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap()
}

/// FNV-1a of 64 bits, in hexadecimal: what stands for numbers that are not in the repository.
pub fn checksum(bytes: impl Iterator<Item = u8>) -> String {
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// Run-length labels, -1 for none, unrolled.
pub fn labels(runs: &Value) -> Vec<Option<usize>> {
    let run = |run: &Value| {
        let class = usize::try_from(run[0].as_i64().unwrap()).ok();
        vec![class; run[1].as_u64().unwrap() as usize]
    };
    runs.as_array().unwrap().iter().flat_map(run).collect()
}
