//! Products of small matrices in the cache, accumulated in vector registers.
//!
//! Burn's matrix product allocates its result and repacks its operands. Where one of the three sizes is
//! the width of a head, 32, that takes longer than the multiplication.

use pulp::Simd;

/// Rows are padded to a multiple of this many values: whole vectors on every processor.
const PAD: usize = 16;

/// Rows of a result that are computed together.
const TILE: usize = 8;

/// A number of values, padded.
pub(super) const fn padded(values: usize) -> usize {
    values.next_multiple_of(PAD)
}

/// The left operand of a product.
pub(super) trait Left: Copy {
    /// `M` values of one column, from row `row` on.
    fn values<const M: usize>(self, row: usize, column: usize) -> [f32; M];
}

/// A matrix whose rows start `stride` values apart.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub values: &'a [f32],
    pub stride: usize,
}

impl<'a> Rows<'a> {
    /// The first `width` values of a row.
    #[inline(always)]
    pub(super) fn row(self, row: usize, width: usize) -> &'a [f32] {
        &self.values[row * self.stride..][..width]
    }
}

impl Left for Rows<'_> {
    #[inline(always)]
    fn values<const M: usize>(self, row: usize, column: usize) -> [f32; M] {
        let mut values = [0.0; M];
        let mut at = row * self.stride + column;
        for value in &mut values {
            *value = self.values[at];
            at += self.stride;
        }
        values
    }
}

/// The transpose of a matrix whose rows start `stride` values apart.
#[derive(Clone, Copy)]
pub(super) struct Transposed<'a>(pub Rows<'a>);

impl Left for Transposed<'_> {
    #[inline(always)]
    fn values<const M: usize>(self, row: usize, column: usize) -> [f32; M] {
        let mut values = [0.0; M];
        let first = column * self.0.stride + row;
        values.copy_from_slice(&self.0.values[first..][..M]);
        values
    }
}

/// Writes the product of `left`, `[rows, depth]`, and `right`, `[depth, width]`, to `result`,
/// `[rows, width]`, or adds it there (`ADD`); `width` is padded.
#[inline(always)]
pub(super) fn product<S: Simd, const ADD: bool>(
    simd: S,
    result: &mut [f32],
    left: impl Left,
    right: &[f32],
    [rows, depth, width]: [usize; 3],
) {
    let vectors = width / S::F32_LANES;
    let (right, _) = S::as_simd_f32s(right);
    let (result, _) = S::as_mut_simd_f32s(result);
    let mut vector = 0;
    while vector < vectors {
        // Two vectors at a time, where there are two.
        let wide = vector + 2 <= vectors;
        let mut row = 0;
        while row < rows {
            let tall = row + TILE <= rows;
            let at = [row, vector, vectors, depth];
            match (tall, wide) {
                (true, true) => tile::<S, ADD, TILE, 2>(simd, result, left, right, at),
                (true, false) => tile::<S, ADD, TILE, 1>(simd, result, left, right, at),
                (false, true) => tile::<S, ADD, 1, 2>(simd, result, left, right, at),
                (false, false) => tile::<S, ADD, 1, 1>(simd, result, left, right, at),
            }
            row += if tall { TILE } else { 1 };
        }
        vector += if wide { 2 } else { 1 };
    }
}

/// `M` rows of `V` vectors of a product.
#[inline(always)]
fn tile<S: Simd, const ADD: bool, const M: usize, const V: usize>(
    simd: S,
    result: &mut [S::f32s],
    left: impl Left,
    right: &[S::f32s],
    [row, vector, vectors, depth]: [usize; 4],
) {
    let mut sums = [[simd.splat_f32s(0.0); V]; M];
    for k in 0..depth {
        let right = &right[k * vectors + vector..][..V];
        let left = left.values::<M>(row, k);
        for m in 0..M {
            let factor = simd.splat_f32s(left[m]);
            for v in 0..V {
                sums[m][v] = simd.mul_add_e_f32s(factor, right[v], sums[m][v]);
            }
        }
    }
    for (m, sums) in sums.iter().enumerate() {
        let result = &mut result[(row + m) * vectors + vector..][..V];
        for (to, &sum) in result.iter_mut().zip(sums) {
            *to = if ADD { simd.add_f32s(*to, sum) } else { sum };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pulp::{Arch, WithSimd};

    /// The product written and then added: twice the product.
    struct Twice<'a, L: Left>(&'a mut [f32], L, &'a [f32], [usize; 3]);

    impl<L: Left> WithSimd for Twice<'_, L> {
        type Output = ();

        fn with_simd<S: Simd>(self, simd: S) {
            product::<S, false>(simd, self.0, self.1, self.2, self.3);
            product::<S, true>(simd, self.0, self.1, self.2, self.3);
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
            // Whole numbers, so that no order of the sums rounds.
            let expected = |at: usize, left_at: &dyn Fn(usize, usize) -> usize| {
                let (row, column) = (at / width, at % width);
                let sum: f32 = (0..depth)
                    .map(|k| left[left_at(row, k)] * right[k * width + column])
                    .sum();
                2.0 * sum
            };
            let mut found = vec![f32::NAN; rows * width];
            let by_rows = Rows {
                values: &left,
                stride: depth,
            };
            Arch::new().dispatch(Twice(&mut found, by_rows, &right, sizes));
            for (at, &found) in found.iter().enumerate() {
                assert_eq!(found, expected(at, &|row, k| row * depth + k));
            }
            let mut found = vec![f32::NAN; rows * width];
            let by_columns = Transposed(Rows {
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
