//! The kernels with the DSP instructions of a Cortex-M4: `SMLAD` and its relatives.
//!
//! Equal to [`Portable`] bit for bit. Loads of several words need addresses that are multiples of four;
//! operands at other addresses, and lengths that the assembly does not cover, go to [`Portable`].

#![allow(unsafe_code, reason = "the kernels are the one place for it")]

mod attention;
mod median;
mod multiply_one;
mod quantize;
mod rescale;

use attention::{COLUMNS, ROWS, eight_columns, four_rows};
use median::four_rectified_medians;
use multiply_one::{COLUMNS as PASS_COLUMNS, multiply_one};
use quantize::{absmax_bits, round_to_codes};

use super::portable::{Portable, factors};
use super::{Kernels, TILE_ROWS};
use crate::units::{CleanSample, Sample, words};

/// The kernels of a Cortex-M4.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CortexM4;

impl Kernels for CortexM4 {
    #[inline]
    fn multiply<const T: usize>(weights: &[i8], inputs: [&[i16]; T], sums: [&mut [i32]; T]) {
        let columns = inputs.first().map_or(0, |input| input.len());
        let fits = inputs
            .iter()
            .zip(&sums)
            .all(|(input, sums)| input.len() == columns && multiply_fits(weights, input, sums));
        if !fits {
            return fall_back(|| Portable::multiply(weights, inputs, sums));
        }
        for (input, sums) in inputs.into_iter().zip(sums) {
            let sums = sums.as_mut_ptr_range();
            // SAFETY: by `multiply_fits` the weights are one or more whole tiles of rows as long as
            // `input`, which is one or more pairs of groups; there is a sum for each row; all is aligned. Both
            // pointers to the sums come from one borrow.
            unsafe {
                multiply_one(
                    weights.as_ptr(),
                    input.as_ptr(),
                    sums.start,
                    columns,
                    sums.end,
                );
            }
        }
    }

    #[inline]
    fn row_products(codes: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        let (columns, count) = (codes.len(), sums.len());
        let fits = columns > 0
            && columns.is_multiple_of(4)
            && stride.is_multiple_of(2)
            && count >= ROWS
            && (count - 1) * stride + columns <= rows.len()
            && is_aligned(codes)
            && is_aligned(rows);
        if !fits {
            return fall_back(|| Portable::row_products(codes, rows, stride, sums));
        }
        let codes = codes.as_ptr_range();
        blocks(count, ROWS, |start| {
            // SAFETY: `start` is at most `count - 4`, so the last of the four rows ends within `rows`, and
            // there are four sums from `start` on; all words are aligned, as `stride` is even; there are
            // four columns or more, a multiple of four.
            unsafe {
                four_rows(
                    codes.start,
                    rows.as_ptr().add(start * stride),
                    stride * size_of::<i16>(),
                    codes.end,
                    sums.as_mut_ptr().add(start),
                );
            }
        });
    }

    #[inline]
    fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        let (count, columns) = (weights.len(), sums.len());
        let fits = count > 1
            && columns >= COLUMNS
            && columns.is_multiple_of(2)
            && stride.is_multiple_of(2)
            && (count - 1) * stride + columns <= rows.len()
            && is_aligned(weights)
            && is_aligned(rows);
        if !fits {
            return fall_back(|| Portable::weighted_rows(weights, rows, stride, sums));
        }
        blocks(columns, COLUMNS, |start| {
            // SAFETY: `start` is at most `columns - 8`, so the eight columns end within the last row, and
            // there are eight sums from `start` on; `start` is even, as 8 and `columns` are, and so all
            // words are aligned; there are two rows or more.
            unsafe {
                eight_columns(
                    weights.as_ptr(),
                    rows.as_ptr().add(start),
                    stride * size_of::<i16>(),
                    count,
                    sums.as_mut_ptr().add(start),
                );
            }
        });
    }

    #[inline]
    fn rescale(outputs: &mut [f32], scale: f32, scales: &[f32], bias: &[f32]) {
        if !rows_fit(scales, bias, outputs.len()) {
            return fall_back(|| Portable::rescale(outputs, scale, scales, bias));
        }
        let scales = scales.as_ptr_range();
        // SAFETY: the range is all of the scales, a multiple of four, not 0; there are as many terms of the bias and at
        // least as many outputs.
        unsafe {
            rescale::rescale(
                outputs.as_mut_ptr(),
                scales.start,
                bias.as_ptr(),
                scales.end,
                scale,
            );
        }
    }

    #[inline]
    fn add_rescaled(sums: &[i32], scale: f32, scales: &[f32], bias: &[f32], residual: &mut [f32]) {
        if !rows_fit(scales, bias, sums.len().min(residual.len())) {
            return fall_back(|| Portable::add_rescaled(sums, scale, scales, bias, residual));
        }
        let scales = scales.as_ptr_range();
        // SAFETY: as above, for the sums and the residual stream.
        unsafe {
            rescale::add_rescaled(
                sums.as_ptr(),
                scales.start,
                bias.as_ptr(),
                scales.end,
                residual.as_mut_ptr(),
                scale,
            );
        }
    }

    #[inline]
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
        let fits = values.len() == codes.len()
            && !values.is_empty()
            && values.len().is_multiple_of(4)
            && is_aligned(codes);
        if !fits {
            return fall_back(|| Portable::quantize(values, limit, codes));
        }
        let values = values.as_ptr_range();
        // SAFETY: the range is all of `values`: a multiple of four, not 0.
        let largest = unsafe { absmax_bits(values.start, values.end) };
        let Some(factors) = factors(f32::from_bits(largest), limit) else {
            codes.fill(0);
            return 0.0;
        };
        // SAFETY: as above; there are as many codes as values, and they are aligned.
        unsafe {
            round_to_codes(
                values.start,
                values.end,
                codes.as_mut_ptr(),
                factors.to_codes,
            );
        }
        factors.to_values
    }

    // Always: whether a call of it stays one otherwise depends on the folder of the source.
    #[inline(always)]
    fn rectified_median(before: Sample, here: Sample, after: Sample) -> CleanSample {
        let [before, here, after] = [before, here, after].map(words);
        let medians: [[u8; 4]; 2] = core::array::from_fn(|word| {
            four_rectified_medians(before[word], here[word], after[word]).to_le_bytes()
        });
        let [[a, b, c, d], [e, f, g, h]] = medians;
        [a, b, c, d, e, f, g, h]
    }
}

/// Whether the matrix consists of whole tiles for this input and these sums, and all is aligned.
#[inline(always)]
fn multiply_fits(weights: &[i8], input: &[i16], sums: &[i32]) -> bool {
    !input.is_empty()
        && input.len().is_multiple_of(PASS_COLUMNS)
        && !sums.is_empty()
        && sums.len().is_multiple_of(TILE_ROWS)
        && weights.len() == sums.len() * input.len()
        && is_aligned(weights)
        && is_aligned(input)
}

/// Whether there are rows, a multiple of four, as many terms of the bias, and at least as many outputs.
#[inline(always)]
fn rows_fit(scales: &[f32], bias: &[f32], outputs: usize) -> bool {
    !scales.is_empty()
        && scales.len().is_multiple_of(4)
        && bias.len() == scales.len()
        && outputs >= scales.len()
}

/// Calls the portable kernel, out of line: a rare case must not take the stack of the usual one.
#[cold]
#[inline(never)]
fn fall_back<T>(kernel: impl FnOnce() -> T) -> T {
    kernel()
}

/// Starts of blocks of `size` that cover `count`, `size` or more. The last block moves back to end at
/// the end; what it overlaps is computed twice, with the same result.
#[inline(always)]
fn blocks(count: usize, size: usize, mut block: impl FnMut(usize)) {
    let mut done = 0;
    while done < count {
        block(done.min(count - size));
        done += size;
    }
}

fn is_aligned<T>(slice: &[T]) -> bool {
    slice.as_ptr().addr().is_multiple_of(4)
}
