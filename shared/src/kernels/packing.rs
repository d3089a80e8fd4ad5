//! Packs a row-major matrix into the tiles of [`Kernels::multiply`](super::Kernels::multiply).

use alloc::vec::Vec;

use super::{GROUP, GROUP_ORDER, TILE_ROWS, row, weights_of};

/// The weights that the bytes of a row mean, in units of 1 / [`WEIGHT_ONE`](super::WEIGHT_ONE) of a byte's.
#[must_use]
pub(crate) fn weights_of_row(bytes: &[i8]) -> Vec<i16> {
    let word = |four: &[i8]| GROUP_ORDER.map(|column| four.get(column).copied().unwrap_or(0));
    let mut weights: Vec<i16> = bytes
        .chunks(GROUP)
        .flat_map(|four| weights_of(word(four)))
        .collect();
    weights.truncate(bytes.len());
    weights
}

/// The tiles of a row-major matrix with this number of columns; rows of zeros fill the last one.
///
/// A matrix without a whole number of rows, or of groups of columns, is returned as it is: no model with
/// it is accepted.
#[must_use]
pub(crate) fn packed(matrix: &[i8], columns: usize) -> Vec<i8> {
    if columns == 0 || !columns.is_multiple_of(GROUP) || !matrix.len().is_multiple_of(columns) {
        return matrix.to_vec();
    }
    let mut matrix = matrix.to_vec();
    matrix.resize(matrix.len().next_multiple_of(TILE_ROWS * columns), 0);
    let mut tiles = Vec::with_capacity(matrix.len());
    for tile in matrix.chunks(TILE_ROWS * columns) {
        for start in (0..columns).step_by(GROUP) {
            for row in tile.chunks_exact(columns) {
                tiles.extend(GROUP_ORDER.map(|column| row[start + column]));
            }
        }
    }
    tiles
}

/// The row-major matrix of `rows` rows and this number of columns whose tiles these are: the inverse of [`packed`].
///
/// Tiles of another size than such a matrix has give no matrix: an empty one.
#[must_use]
pub(crate) fn unpacked(tiles: &[i8], rows: usize, columns: usize) -> Vec<i8> {
    if !columns.is_multiple_of(GROUP) || tiles.len() != rows.next_multiple_of(TILE_ROWS) * columns {
        return Vec::new();
    }
    (0..rows)
        .flat_map(|row| row::bytes(tiles, row, columns))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounded bytes of a row in units of a byte.
    fn bytes_of_row(weights: &[f32]) -> Vec<i8> {
        let mut bytes = alloc::vec![0; weights.len()];
        row::round_row(|column| weights[column], &mut bytes);
        bytes
    }

    #[test]
    fn a_tile_holds_groups_of_columns_row_by_row_and_the_last_tile_is_filled_with_zeros() {
        // Tens digit: row; ones digit: column.
        let matrix: Vec<i8> = (0..5)
            .flat_map(|row| (0..8).map(move |column| 10 * row + column))
            .collect();
        let expected = [
            [0, 2, 1, 3, 10, 12, 11, 13, 20, 22, 21, 23, 30, 32, 31, 33],
            [4, 6, 5, 7, 14, 16, 15, 17, 24, 26, 25, 27, 34, 36, 35, 37],
            [40, 42, 41, 43, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
            [44, 46, 45, 47, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        ];
        assert_eq!(packed(&matrix, 8), expected.concat());
    }

    #[test]
    fn an_incomplete_matrix_is_returned_as_it_is() {
        let odd: Vec<i8> = (0..21).collect();
        for columns in [0, 3, 6, 7, 8] {
            assert_eq!(packed(&odd, columns), odd);
        }
        assert!(packed(&[], 4).is_empty());
    }

    #[test]
    fn a_weight_is_its_own_byte_and_below_it_the_byte_before() {
        // Columns 0, 2, 1, 3 follow one another in the word.
        assert_eq!(
            weights_of_row(&[1, 3, 2, 4]),
            [256, 3 * 256 + 2, 2 * 256 + 1, 4 * 256 + 3]
        );
        assert_eq!(
            weights_of_row(&[-1, 0, 5, -128]),
            [-256, 5, 5 * 256 + 255, -128 * 256]
        );
        assert_eq!(weights_of_row(&[0; 8]), [0; 8]);
    }

    #[test]
    fn rounded_weights_are_within_half_a_unit() {
        let mut noise = crate::model::noise::Noise(5);
        let mut drawn = |columns| (0..columns).map(|_| noise.signed() * 127.0).collect();
        let extremes = [127.0, -127.0, 127.0, -127.0, -127.0, -127.0, -127.0, 127.0];
        let rows: [Vec<f32>; 4] = [extremes.into(), drawn(4), drawn(8), drawn(80)];
        for row in rows {
            let bytes = bytes_of_row(&row);
            for (weight, found) in row.iter().zip(weights_of_row(&bytes)) {
                let distance = f32::from(found) / 256.0 - weight;
                assert!(distance.abs() <= 0.500_01, "{weight} {found}");
            }
        }
        assert_eq!(bytes_of_row(&[0.0; 12]), [0; 12]);
    }
}
