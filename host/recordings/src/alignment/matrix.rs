//! A matrix of eight rows and columns, one for each electrode.

use shared::units::CHANNELS;

/// Row-major matrix with one row and one column for each electrode.
pub(super) type Matrix = [[f64; CHANNELS]; CHANNELS];

/// The inverse of a symmetric positive definite matrix, by Gauss-Jordan elimination, which needs no pivoting there.
pub(super) fn inverse(mut matrix: Matrix) -> Matrix {
    let mut inverse = Matrix::default();
    for (row, values) in inverse.iter_mut().enumerate() {
        values[row] = 1.0;
    }
    for pivot in 0..CHANNELS {
        let scale = 1.0 / matrix[pivot][pivot];
        for column in 0..CHANNELS {
            matrix[pivot][column] *= scale;
            inverse[pivot][column] *= scale;
        }
        let (left, right) = (matrix[pivot], inverse[pivot]);
        for row in (0..CHANNELS).filter(|&row| row != pivot) {
            let factor = matrix[row][pivot];
            for column in 0..CHANNELS {
                matrix[row][column] -= factor * left[column];
                inverse[row][column] -= factor * right[column];
            }
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        // Diagonally dominant, therefore positive definite.
        let mut matrix = Matrix::default();
        for (row, values) in matrix.iter_mut().enumerate() {
            for (column, value) in values.iter_mut().enumerate() {
                let apart = row.abs_diff(column) as f64;
                *value = if apart == 0.0 {
                    5.0
                } else {
                    1.0 / (1.0 + apart)
                };
            }
        }
        let inverse = inverse(matrix);
        let product = |row: usize, column: usize| -> f64 {
            let products = matrix[row].iter().zip(&inverse);
            products.map(|(value, other)| value * other[column]).sum()
        };
        for (row, column) in (0..CHANNELS * CHANNELS).map(|at| (at / CHANNELS, at % CHANNELS)) {
            let expected = if row == column { 1.0 } else { 0.0 };
            let found = product(row, column);
            assert!((found - expected).abs() < 1e-9, "{row} {column}: {found}");
        }
    }
}
