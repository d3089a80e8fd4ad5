//! Packs a row-major matrix into the tiles of [`Kernels::multiply`](super::Kernels::multiply).

use alloc::vec::Vec;

use super::{GROUP, GROUP_ORDER, TILE_ROWS};

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
    let place = |row: usize, column: usize| {
        let within = GROUP_ORDER.iter().position(|&own| own == column % GROUP);
        let group = column / GROUP * TILE_ROWS * GROUP + row % TILE_ROWS * GROUP;
        row / TILE_ROWS * TILE_ROWS * columns + group + within.unwrap_or(0)
    };
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| tiles[place(row, column)]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn unpacked_tiles_are_the_matrix_again() {
        for (rows, columns) in [(1, 4), (4, 8), (5, 8), (18, 80), (7, 12)] {
            let matrix: Vec<i8> = (0..rows * columns)
                .map(|at| (at * 37 % 251) as i8)
                .collect();
            assert_eq!(unpacked(&packed(&matrix, columns), rows, columns), matrix);
        }
        assert!(unpacked(&[0; 20], 1, 4).is_empty());
    }
}
