//! Products of matrices that lie in the cache, added up in vector registers.
//!
//! A backend's product allocates its result and packs its factors, which costs more than the
//! product itself where a head's width, 32, is one of the three sizes.

use pulp::Simd;

/// Rows are padded to a multiple of this many values, whole vectors on every processor.
pub const PAD: usize = 16;

/// Rows of a result that are computed together.
const TILE: usize = 8;

/// A padded number of values.
pub const fn padded(values: usize) -> usize {
    values.next_multiple_of(PAD)
}

/// The left factor of a product.
pub trait Left: Copy {
    /// `M` values below each other: rows from `row` on, one column.
    fn values<const M: usize>(self, row: usize, column: usize) -> [f32; M];
}

/// A matrix whose rows start `stride` values apart.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    pub values: &'a [f32],
    pub stride: usize,
}

impl<'a> Rows<'a> {
    /// A row's first values.
    #[inline(always)]
    pub fn row(self, row: usize, width: usize) -> &'a [f32] {
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
pub struct Transposed<'a>(pub Rows<'a>);

impl Left for Transposed<'_> {
    #[inline(always)]
    fn values<const M: usize>(self, row: usize, column: usize) -> [f32; M] {
        let mut values = [0.0; M];
        let first = column * self.0.stride + row;
        values.copy_from_slice(&self.0.values[first..][..M]);
        values
    }
}

/// Writes to `result`, `[rows, width]`, or adds to it (`ADD`), the product of `left`,
/// `[rows, depth]`, and `right`, `[depth, width]`; `width` is padded.
#[inline(always)]
pub fn product<S: Simd, const ADD: bool>(
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
        // Two vectors side by side, where there are two.
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

    /// Twice the product: once written, once added.
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
