//! Products of small matrices in the cache, accumulated in vector registers.
//!
//! Burn's matrix product allocates its result and repacks its operands. Where one of the three sizes is
//! the width of a head, 32, that takes longer than the multiplication.

use pulp::{Simd, WithSimd};

/// Multiple that rows are padded to, in values: whole vectors on every processor.
const PAD: usize = 16;

/// Number of rows of a result that are computed together.
const TILE: usize = 8;

/// Number of rows that are computed together when fewer than [`TILE`] are left.
const HALF: usize = 4;

/// Rounds a number of values up to the padding.
pub(crate) const fn padded(values: usize) -> usize {
    values.next_multiple_of(PAD)
}

/// Left operand of a product.
pub(crate) trait Left: Copy {
    /// Returns the first `depth` columns of the `M` rows from `row` on.
    fn rows<const M: usize>(self, row: usize, depth: usize) -> impl Columns<M>;
}

/// Columns of `M` rows of a left operand.
pub(crate) trait Columns<const M: usize>: Copy {
    /// Returns the `M` values of a column.
    fn column(self, column: usize) -> [f32; M];
}

/// A matrix whose rows start `stride` values apart.
#[derive(Clone, Copy)]
pub(crate) struct MatrixRows<'a> {
    pub values: &'a [f32],
    pub stride: usize,
}

/// A matrix to write to, whose rows start `stride` values apart.
pub(crate) struct RowsMut<'a> {
    pub values: &'a mut [f32],
    pub stride: usize,
}

impl<'a> MatrixRows<'a> {
    /// Returns the submatrix that begins at a row and a column.
    #[inline(always)]
    pub(crate) fn from(self, row: usize, column: usize) -> Self {
        let first = row * self.stride + column;
        Self {
            values: self.values.get(first..).unwrap_or_default(),
            stride: self.stride,
        }
    }

    /// Returns the first `width` values of a row.
    #[inline(always)]
    pub(crate) fn row(self, row: usize, width: usize) -> &'a [f32] {
        &self.values[row * self.stride..][..width]
    }
}

impl RowsMut<'_> {
    /// Returns the submatrix that begins at a row and a column.
    #[inline(always)]
    pub(crate) fn from(&mut self, row: usize, column: usize) -> RowsMut<'_> {
        let first = row * self.stride + column;
        RowsMut {
            values: self.values.get_mut(first..).unwrap_or_default(),
            stride: self.stride,
        }
    }
}

impl Left for MatrixRows<'_> {
    #[inline(always)]
    fn rows<const M: usize>(self, row: usize, depth: usize) -> impl Columns<M> {
        let mut rows = [[].as_slice(); M];
        for (m, values) in rows.iter_mut().enumerate() {
            *values = self.row(row + m, depth);
        }
        ByRow(rows)
    }
}

/// Rows as slices of one length, so that the compiler checks a column once.
#[derive(Clone, Copy)]
struct ByRow<'a, const M: usize>([&'a [f32]; M]);

impl<const M: usize> Columns<M> for ByRow<'_, M> {
    #[inline(always)]
    fn column(self, column: usize) -> [f32; M] {
        let mut values = [0.0; M];
        for (value, row) in values.iter_mut().zip(self.0) {
            *value = row[column];
        }
        values
    }
}

/// The transpose of a matrix whose rows start `stride` values apart.
#[derive(Clone, Copy)]
pub(crate) struct Transposed<'a>(pub MatrixRows<'a>);

impl Left for Transposed<'_> {
    #[inline(always)]
    fn rows<const M: usize>(self, row: usize, _depth: usize) -> impl Columns<M> {
        ByColumn(self.0.from(0, row))
    }
}

#[derive(Clone, Copy)]
struct ByColumn<'a>(MatrixRows<'a>);

impl<const M: usize> Columns<M> for ByColumn<'_> {
    #[inline(always)]
    fn column(self, column: usize) -> [f32; M] {
        let mut values = [0.0; M];
        values.copy_from_slice(self.0.row(column, M));
        values
    }
}

/// Writes the product of `left`, `[rows, depth]`, and `right`, `[depth, width]`, to `result`,
/// `[rows, width]`, or adds it there (`ADD`); `width` is padded.
#[inline(always)]
pub(crate) fn product<S: Simd, const ADD: bool>(
    simd: S,
    result: RowsMut<'_>,
    left: impl Left,
    right: MatrixRows<'_>,
    sizes: [usize; 3],
) {
    // Compiled once for all callers, not into each.
    simd.vectorize(Product::<_, ADD> {
        result,
        left,
        right,
        sizes,
    });
}

struct Product<'a, L: Left, const ADD: bool> {
    result: RowsMut<'a>,
    left: L,
    right: MatrixRows<'a>,
    sizes: [usize; 3],
}

impl<L: Left, const ADD: bool> WithSimd for Product<'_, L, ADD> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let [rows, depth, width] = self.sizes;
        let vectors = width / S::F32_LANES;
        let mut vector = 0;
        while vector < vectors {
            // Two vectors at a time, if two are left.
            let wide = vector + 2 <= vectors;
            let column = vector * S::F32_LANES;
            let mut row = 0;
            while row < rows {
                let at = [row, column, depth];
                let left = rows - row;
                row += match (left >= TILE, left >= HALF, wide) {
                    (true, _, true) => self.tile::<S, TILE, 2>(simd, at),
                    (true, _, false) => self.tile::<S, TILE, 1>(simd, at),
                    (false, true, true) => self.tile::<S, HALF, 2>(simd, at),
                    (false, true, false) => self.tile::<S, HALF, 1>(simd, at),
                    (false, false, true) => self.tile::<S, 1, 2>(simd, at),
                    (false, false, false) => self.tile::<S, 1, 1>(simd, at),
                };
            }
            vector += if wide { 2 } else { 1 };
        }
    }
}

impl<L: Left, const ADD: bool> Product<'_, L, ADD> {
    /// Computes `M` rows of `V` vectors of the product. Returns `M`.
    #[inline(always)]
    fn tile<S: Simd, const M: usize, const V: usize>(
        &mut self,
        simd: S,
        [row, column, depth]: [usize; 3],
    ) -> usize {
        let left = self.left.rows::<M>(row, depth);
        let right = self.right.from(0, column);
        let mut sums = [[simd.splat_f32s(0.0); V]; M];
        for k in 0..depth {
            let (right, _) = S::as_simd_f32s(right.row(k, V * S::F32_LANES));
            let left = left.column(k);
            for m in 0..M {
                let factor = simd.splat_f32s(left[m]);
                for v in 0..V {
                    sums[m][v] = simd.mul_add_e_f32s(factor, right[v], sums[m][v]);
                }
            }
        }
        let result = self.result.from(row, column);
        for (m, sums) in sums.iter().enumerate() {
            let result = &mut result.values[m * result.stride..][..V * S::F32_LANES];
            let (result, _) = S::as_mut_simd_f32s(result);
            for (to, &sum) in result.iter_mut().zip(sums) {
                *to = if ADD { simd.add_f32s(*to, sum) } else { sum };
            }
        }
        M
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    /// Writes a product and then adds it: twice the product.
    struct Twice<'a, L: Left>(&'a mut [f32], L, &'a [f32], [usize; 3]);

    impl<L: Left> WithSimd for Twice<'_, L> {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            let stride = self.3[2];
            let right = MatrixRows {
                values: self.2,
                stride,
            };
            let mut result = RowsMut {
                values: self.0,
                stride,
            };
            product::<S, false>(simd, result.from(0, 0), self.1, right, self.3);
            product::<S, true>(simd, result, self.1, right, self.3);
        }
    }

    #[test]
    fn products_are_those_of_the_definition() {
        let value = |i: usize| ((i * 37) % 19) as f32 - 9.0;
        for sizes in [
            [1, 1, 16],
            [6, 5, 32],
            [7, 32, 48],
            [18, 40, 64],
            [20, 3, 16],
        ] {
            let [rows, depth, width] = sizes;
            let left: Vec<f32> = (0..rows * depth).map(value).collect();
            let right: Vec<f32> = (0..depth * width).map(|i| value(i + 5)).collect();
            // Integers, so that no order of the sums rounds.
            let expected = |at: usize, left_at: &dyn Fn(usize, usize) -> usize| {
                let (row, column) = (at / width, at % width);
                let sum: f32 = (0..depth)
                    .map(|k| left[left_at(row, k)] * right[k * width + column])
                    .sum();
                2.0 * sum
            };
            let mut found = vec![f32::NAN; rows * width];
            let by_rows = MatrixRows {
                values: &left,
                stride: depth,
            };
            Arch::new().dispatch(Twice(&mut found, by_rows, &right, sizes));
            for (at, &found) in found.iter().enumerate() {
                assert_eq!(found, expected(at, &|row, k| row * depth + k));
            }
            let mut found = vec![f32::NAN; rows * width];
            let by_columns = Transposed(MatrixRows {
                values: &left,
                stride: rows,
            });
            Arch::new().dispatch(Twice(&mut found, by_columns, &right, sizes));
            for (at, &found) in found.iter().enumerate() {
                assert_eq!(found, expected(at, &|row, k| k * rows + row));
            }
        }
    }
}
