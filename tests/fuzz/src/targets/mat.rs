//! MATLAB files: any bytes behind a right header, and any variables, compressed or not.

use crate::input::Input;
pub use recordings::readers::mat::fixture::{compressed, file, packed, variable};
use recordings::readers::mat::parse;
use recordings::readers::npy::Values;

/// Bytes of a stored block: small, so that a variable has several.
const BLOCK: usize = 200;

/// Takes a file unchanged, its bytes behind a header, and its bytes as the content of variables.
pub fn run(data: &[u8]) {
    check(data);
    check(&file(&[data.to_vec()]));
    let mut input = Input(data);
    let mut variables = Vec::new();
    while !input.is_empty() && variables.len() < 4 {
        let how = input.byte();
        let name = String::from_utf8_lossy(input.take(usize::from(how % 8))).into_owned();
        let shape = [i32::from_le_bytes(input.array()), i32::from(input.byte())];
        let (class, kind) = (input.byte() % 17, u32::from(input.byte() % 16));
        let mut content = variable(&name, shape, class, kind, input.short());
        if how & 0x10 != 0 {
            let at = input.byte();
            let changed = input.byte();
            let count = content.len();
            content[usize::from(at) % count] = changed;
        }
        // Compressing takes as long as ten executions, so one variable of eight is compressed.
        variables.push(match how >> 5 {
            0..=3 => content,
            4..=6 => stored(&content),
            _ => compressed(&content),
        });
    }
    check(&file(&variables));
}

/// Returns the compressed form of content that a compressor cannot make shorter: blocks that are stored.
fn stored(content: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0x78, 0x01];
    let count = content.len().div_ceil(BLOCK).max(1);
    for number in 0..count {
        let block = &content[number * BLOCK..content.len().min((number + 1) * BLOCK)];
        let length = block.len() as u16;
        bytes.push(u8::from(number + 1 == count));
        bytes.extend(length.to_le_bytes());
        bytes.extend((!length).to_le_bytes());
        bytes.extend(block);
    }
    let (low, high) = content.iter().fold((1, 0), |(low, high), &byte| {
        let low = (low + u32::from(byte)) % 65_521;
        (low, (high + low) % 65_521)
    });
    bytes.extend((high << 16 | low).to_be_bytes());
    packed(&bytes)
}

fn check(bytes: &[u8]) {
    let Ok(matrices) = parse(bytes) else { return };
    for matrix in matrices {
        let (&[rows, columns], Values::Numbers(values)) = (&matrix.shape[..], &matrix.values)
        else {
            panic!("a matrix of numbers, found {}", matrix.describe());
        };
        assert_eq!(rows.checked_mul(columns), Some(values.len()));
        assert!(matrix.byte_of_row(rows) < bytes.len() as u64);
    }
}
