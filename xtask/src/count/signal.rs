//! The samples to count over: synthetic ones, or a recording.

use std::path::Path;

use anyhow::{Context as _, Result};

use crate::read;

/// 20 s of noise, in turns weak as at rest and strong as in a fist, 2 s each.
pub fn synthetic() -> Vec<u8> {
    const SAMPLES: u64 = 4000;
    let mut state = 1_u64;
    let mut byte = |amplitude: u64| {
        // Knuth's linear congruential generator; its high bits are the random ones.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % (2 * amplitude + 1)).wrapping_sub(amplitude) as u8
    };
    let sample = |index: u64| {
        if (index / 400).is_multiple_of(2) {
            3
        } else {
            80
        }
    };
    (0..SAMPLES)
        .flat_map(|index| [sample(index); 8])
        .map(&mut byte)
        .collect()
}

/// The samples of an npy file.
pub fn read_npy(path: &Path) -> Result<Vec<u8>> {
    npy_body(&read(path)?)
        .with_context(|| format!("{} is no npy file of bytes in rows of 8", path.display()))
}

/// The values of an npy file of version 1: magic, version, length of the header, header, values.
fn npy_body(bytes: &[u8]) -> Option<Vec<u8>> {
    let rest = bytes.strip_prefix(b"\x93NUMPY\x01\x00")?;
    let (length, rest) = rest.split_first_chunk()?;
    let (header, values) = rest.split_at_checked(u16::from_le_bytes(*length).into())?;
    let header = std::str::from_utf8(header).ok()?;
    let fits = header.contains("'|i1'") && header.contains("'fortran_order': False");
    (fits && values.len().is_multiple_of(8)).then(|| values.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bytes_in_rows_of_8_are_a_recording() {
        let file = |kind: &str, values: &[u8]| {
            let header =
                format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (1, 8), }}");
            let length = (header.len() as u16).to_le_bytes();
            [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), values].concat()
        };
        assert_eq!(npy_body(&file("|i1", &[7; 8])), Some(vec![7; 8]));
        assert_eq!(npy_body(&file("|i1", &[7; 9])), None);
        assert_eq!(npy_body(&file("<i8", &[7; 8])), None);
        assert_eq!(npy_body(b"no npy"), None);
    }

    #[test]
    fn the_synthetic_signal_has_rests_and_fists() {
        let values: Vec<i8> = synthetic().into_iter().map(|byte| byte as i8).collect();
        let loudest = |range: std::ops::Range<usize>| {
            values[range].iter().map(|value| value.unsigned_abs()).max()
        };
        assert_eq!(values.len(), 4000 * 8);
        assert_eq!(loudest(0..400 * 8), Some(3));
        assert_eq!(loudest(400 * 8..800 * 8), Some(80));
    }
}
