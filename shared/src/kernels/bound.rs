//! The bound of the sums of a matrix.

use super::{GROUP, TILE_ROWS, weights_of};

/// The largest magnitude of codes with which no sum of the matrix leaves 32 bits: at most an `i16`'s.
///
/// A row's sum is at most the sum of its weights' magnitudes times the largest code. For the weights of a trained
/// matrix of 64 columns it is some 4000, and 1023 if all of them are extreme. The tiles are those of
/// [`Kernels::multiply`](super::Kernels::multiply). Cost: one pass.
#[must_use]
pub(crate) fn code_limit(tiles: &[i8], columns: usize) -> i16 {
    let tile = TILE_ROWS * columns;
    let largest = tiles
        .chunks(tile.max(1))
        .map(largest_of_tile)
        .max()
        .unwrap_or(0);
    let limit = (i32::MAX as u32)
        .checked_div(largest)
        .unwrap_or(i32::MAX as u32);
    i16::try_from(limit).unwrap_or(i16::MAX)
}

/// The largest sum of magnitudes of a tile's rows.
fn largest_of_tile(tile: &[i8]) -> u32 {
    let mut sums = [0_u32; TILE_ROWS];
    let (words, _) = tile.as_chunks::<GROUP>();
    for words in words.chunks_exact(TILE_ROWS) {
        for (sum, &word) in sums.iter_mut().zip(words) {
            *sum += weights_of(word)
                .map(|weight| u32::from(weight.unsigned_abs()))
                .iter()
                .sum::<u32>();
        }
    }
    sums.into_iter().max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::packing::{packed, weights_of_row};

    #[test]
    fn the_limit_times_the_largest_row_fits_and_one_more_does_not() {
        for (rows, columns, factor) in [(1, 8, 5), (5, 64, 37), (12, 80, 111), (4, 256, 3)] {
            let bytes: alloc::vec::Vec<i8> = (0..rows * columns)
                .map(|at| (at * factor % 255) as u8 as i8)
                .collect();
            let size = |row: &[i8]| -> i64 {
                let weights = weights_of_row(row).into_iter();
                weights.map(|weight| i64::from(weight).abs()).sum()
            };
            let largest = bytes.chunks(columns).map(size).max().unwrap();
            let limit = i64::from(code_limit(&packed(&bytes, columns), columns));
            assert!(limit * largest <= i64::from(i32::MAX));
            assert!((limit + 1) * largest > i64::from(i32::MAX) || limit == i64::from(i16::MAX));
        }
    }

    #[test]
    fn the_limit_of_extreme_and_of_no_weights() {
        // -128 x 256, and three times -128 x 256 + 128.
        let largest = 16 * (32_768 + 3 * 32_640);
        let limit = i32::from(code_limit(&[i8::MIN; 4 * 64], 64));
        assert_eq!(limit, i32::MAX / largest);
        assert_eq!(code_limit(&[0; 4 * 64], 64), i16::MAX);
        assert_eq!(code_limit(&[], 64), i16::MAX);
    }
}
