//! The integer kernels of preprocessing and encoder, and the choice between their implementations.
//!
//! [`portable`] is the reference; an implementation for a processor gives the same results faster;
//! [`checks`] tests any of them. Callers keep the bounds stated here: accumulators are 32 bits wide, and
//! an overflow is not detected at run time.

mod bound;
#[cfg(test)]
mod checks;
#[cfg(cortex_m4)]
mod cortex_m4;
#[cfg(any(test, feature = "write"))]
pub(crate) mod packing;
mod portable;
pub(crate) mod row;
#[cfg(target_arch = "x86_64")]
mod sse2;

pub(crate) use bound::code_limit;

use crate::units::{CleanSample, Sample};

/// The implementation for this target.
#[cfg(not(any(cortex_m4, target_arch = "x86_64")))]
pub(crate) type Active = portable::Portable;
/// The implementation for this target.
#[cfg(target_arch = "x86_64")]
pub(crate) type Active = sse2::Sse2;
/// The implementation for this target.
#[cfg(cortex_m4)]
pub(crate) type Active = cortex_m4::CortexM4;

/// Longest row of weights: the second matrix of a feed-forward of 2 x 256.
pub(crate) const MAX_COLUMNS: usize = 512;
/// Largest code of a query, and of an attention weight times the scale of its value.
pub(crate) const QUERY_LIMIT: i16 = 4095;
/// Largest code of a key or a value.
pub(crate) const KEY_LIMIT: i16 = 8191;
/// Most terms of a product of codes: a head's width, or the span.
pub(crate) const MAX_TERMS: usize = 32;
/// Rows of a tile of weights (see [`Kernels::multiply`]).
pub(crate) const TILE_ROWS: usize = 4;
/// Columns of a group: one word of a 32-bit core.
pub(crate) const GROUP: usize = 4;
/// Order of a group's columns in its word. The two halfwords of a word are the weights of columns 2 and 3, those of the
/// word shifted left by a byte are the weights of columns 0 and 1: see [`weights_of`].
pub(crate) const GROUP_ORDER: [usize; GROUP] = [0, 2, 1, 3];
/// Integer of a weight of 1: its own byte counts 256, the byte before it 1.
pub(crate) const WEIGHT_ONE: i32 = 256;

// The sum of a row's magnitudes, of which `code_limit` makes the limit of the codes.
const _: () = assert!(MAX_COLUMNS as u64 * 32_768 <= u32::MAX as u64);
// Query x key over a head, attention weight x value over the span: below 2^12 x 2^13 x 2^5 = 2^30.
const _: () = assert!(QUERY_LIMIT as i64 * KEY_LIMIT as i64 * MAX_TERMS as i64 <= i32::MAX as i64);

/// The weights of a word of four bytes, in the order of their columns, in units of 1 / [`WEIGHT_ONE`].
///
/// A weight is the 16-bit number of its own byte and, as the low byte, the byte before it in the word: for the first
/// one 0. So a core reads two weights as they lie in a register and the other two after one shift, where weights of 8
/// bits would have to be unpacked first. It costs no accuracy: whoever rounds a weight knows the byte before it, and the
/// remainder is within half a unit of the own byte as ever.
#[inline(always)]
pub(crate) const fn weights_of(word: [i8; GROUP]) -> [i16; GROUP] {
    const { assert!(matches!(GROUP_ORDER, [0, 2, 1, 3])) }
    let word = u32::from_le_bytes([word[0] as u8, word[1] as u8, word[2] as u8, word[3] as u8]);
    let shifted = word << 8;
    [
        shifted as i16,
        (shifted >> 16) as i16,
        word as i16,
        (word >> 16) as i16,
    ]
}

/// Numbers at a multiple of four bytes, where a core can load several words at once.
///
/// Kernels take slices at any address; they are fast at a multiple of four.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(C, align(4))]
pub struct Aligned<T: ?Sized>(pub T);

/// The kernels: pure functions.
pub(crate) trait Kernels {
    /// `sums[t][r] = sum over c of weights[r][c] * inputs[t][c]`, exactly, for each of `T` tokens.
    ///
    /// There are as many rows as a token has sums, a multiple of [`TILE_ROWS`], and as many columns as it
    /// has inputs, a multiple of [`GROUP`] and at most [`MAX_COLUMNS`]. Inputs are within the matrix's
    /// [`code_limit`]. Weights are stored in tiles of [`TILE_ROWS`] rows: group of columns after group, in a
    /// group row after row, the four weights of a row in one word ([`weights_of`]). All tokens have the same
    /// length.
    fn multiply<const T: usize>(weights: &[i8], inputs: [&[i16]; T], sums: [&mut [i32]; T]);

    /// `sums[r] = sum over c of rows[r * stride + c] * codes[c]`, exactly.
    ///
    /// At most [`MAX_TERMS`] columns; |codes| <= [`QUERY_LIMIT`] and |rows| <= [`KEY_LIMIT`]. Fast if columns
    /// and stride are multiples of 4 and there are four rows or more.
    fn row_products(codes: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]);

    /// `sums[c] = sum over r of weights[r] * rows[r * stride + c]`, exactly.
    ///
    /// At most [`MAX_TERMS`] rows; |weights| <= [`QUERY_LIMIT`] and |rows| <= [`KEY_LIMIT`]. Fast if there are
    /// two rows or more, an even number of sums, eight or more, and the stride is even.
    fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]);

    /// `outputs[r] = sum * (scale * scales[r]) + bias[r]`, `sum` being the integer whose bits `outputs[r]` has before.
    ///
    /// Scales as many outputs as there are scales and bias terms; further ones stay as they are. Fast with a multiple of four.
    fn rescale(outputs: &mut [f32], scale: f32, scales: &[f32], bias: &[f32]);

    /// `residual[r] += sums[r] * (scale * scales[r]) + bias[r]`, as [`Kernels::rescale`].
    fn add_rescaled(sums: &[i32], scale: f32, scales: &[f32], bias: &[f32], residual: &mut [f32]);

    /// Writes codes in `-limit..=limit` and returns their scale: `value` is about `code * scale`.
    ///
    /// The scale is `absmax / limit`, each code `value * (limit / absmax)` rounded to the nearest,
    /// halves to even. If the largest magnitude is below 1e-30 or not finite, all codes and the scale are 0.
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32;

    /// `|median of before[c], here[c], after[c]|` of each channel, 0 to 128.
    fn rectified_median(before: Sample, here: Sample, after: Sample) -> CleanSample;
}
