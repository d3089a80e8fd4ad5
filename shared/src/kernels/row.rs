//! Rows of a matrix in the tiles of [`Kernels::multiply`](super::Kernels::multiply): where a weight lies, how it is read and rounded.

use super::{GROUP, GROUP_ORDER, TILE_ROWS, WEIGHT_ONE, weights_of};
use crate::arithmetic::{absmax, round};

/// Index, in the tiles, of the word of a row's columns `group` to `group + 3`; `columns` and `group` are multiples of four.
const fn word(row: usize, group: usize, columns: usize) -> usize {
    (row / TILE_ROWS * columns + group) * TILE_ROWS + row % TILE_ROWS * GROUP
}

/// The weights of a row in the order of its columns, in units of 1 / [`WEIGHT_ONE`] of a byte's.
pub(crate) fn weights(tiles: &[i8], row: usize, columns: usize) -> impl Iterator<Item = i16> {
    (0..columns).step_by(GROUP).flat_map(move |group| {
        let start = word(row, group, columns);
        weights_of(core::array::from_fn(|byte| tiles[start + byte]))
    })
}

/// The bytes of a row in the order of its columns.
#[cfg(any(test, feature = "write"))]
pub(crate) fn bytes(tiles: &[i8], row: usize, columns: usize) -> impl Iterator<Item = i8> {
    (0..columns).step_by(GROUP).flat_map(move |group| {
        let start = word(row, group, columns);
        let mut four = [0; GROUP];
        for (byte, column) in GROUP_ORDER.into_iter().enumerate() {
            four[column] = tiles[start + byte];
        }
        four
    })
}

/// Writes the bytes of a row, in the order of its columns, to the tiles.
pub(crate) fn put(tiles: &mut [i8], row: usize, bytes: &[i8]) {
    for (place, four) in bytes.chunks_exact(GROUP).enumerate() {
        let start = word(row, GROUP * place, bytes.len());
        for (byte, column) in GROUP_ORDER.into_iter().enumerate() {
            tiles[start + byte] = four[column];
        }
    }
}

/// Quantizes a row to bytes in the order of its columns; returns the scale, the value of a weight byte of 1.
///
/// The scale is the row's largest magnitude over 127: 0 for a row of zeros, infinite or NaN if a weight is.
#[must_use]
pub(crate) fn quantize(weights: &[f32], bytes: &mut [i8]) -> f32 {
    let largest = absmax(weights);
    // Not by an inverse: that of a tiny number is infinite.
    let unit = |weight: f32| {
        if largest > 0.0 {
            weight / largest * 127.0
        } else {
            0.0
        }
    };
    round_row(|column| unit(weights[column]), bytes);
    largest / 127.0
}

/// Rounds a row of weights in units of a byte, -127 to 127, to bytes in the order of its columns.
///
/// The error of the bytes, as [`weights_of`] reads them, is half a unit at most, above 127 less than one.
pub(crate) fn round_row(weight: impl Fn(usize) -> f32, bytes: &mut [i8]) {
    for (place, four) in bytes.chunks_mut(GROUP).enumerate() {
        let mut before = 0;
        for column in GROUP_ORDER {
            before = match four.get_mut(column) {
                Some(byte) => {
                    *byte = byte_of(weight(GROUP * place + column), before);
                    *byte
                }
                None => 0,
            };
        }
    }
}

/// Byte of a weight that lies behind the byte `before` in its word. With `before` as its low byte it means the number
/// nearest to the weight ([`weights_of`]), in units of a byte.
fn byte_of(weight: f32, before: i8) -> i8 {
    let low = f32::from(before.cast_unsigned()) / WEIGHT_ONE as f32;
    // Saturates beyond -128 and 127.
    round(weight - low).clamp(-128, 127) as i8
}
