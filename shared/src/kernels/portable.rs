//! The kernels in plain Rust: the reference that every other implementation equals bit for bit.

use super::{GROUP, Kernels, TILE_ROWS, weights_of};
use crate::arithmetic::{absmax, round_to_even};
use crate::units::{CleanSample, Sample};

/// Below this a token counts as zero, so that `limit / absmax` is finite.
const SMALLEST: f32 = 1e-30;

/// Plain Rust, written so that the compiler can vectorise it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Kernels for Portable {
    #[inline]
    fn multiply<const T: usize>(weights: &[i8], inputs: [&[i16]; T], mut sums: [&mut [i32]; T]) {
        let columns = inputs.first().map_or(0, |input| input.len());
        if columns == 0 {
            sums.iter_mut().for_each(|sums| sums.fill(0));
            return;
        }
        for (place, weights) in weights.chunks_exact(TILE_ROWS * columns).enumerate() {
            for (sums, of_tile) in sums.iter_mut().zip(tile(weights, inputs)) {
                if let Some(sums) = sums.as_chunks_mut().0.get_mut(place) {
                    *sums = of_tile;
                }
            }
        }
    }

    #[inline]
    fn row_products(codes: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        for (sum, row) in sums.iter_mut().zip(rows.chunks(stride.max(1))) {
            *sum = codes
                .iter()
                .zip(row)
                .map(|(&a, &b)| i32::from(a) * i32::from(b))
                .sum();
        }
    }

    #[inline]
    fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        sums.fill(0);
        for (&weight, row) in weights.iter().zip(rows.chunks(stride.max(1))) {
            for (sum, &value) in sums.iter_mut().zip(row) {
                *sum += i32::from(weight) * i32::from(value);
            }
        }
    }

    #[inline]
    fn rescale(outputs: &mut [f32], scale: f32, scales: &[f32], bias: &[f32]) {
        for (output, (row_scale, bias)) in outputs.iter_mut().zip(scales.iter().zip(bias)) {
            let sum = output.to_bits().cast_signed();
            *output = sum as f32 * (scale * row_scale) + bias;
        }
    }

    #[inline]
    fn add_rescaled(sums: &[i32], scale: f32, scales: &[f32], bias: &[f32], residual: &mut [f32]) {
        let rows = residual.iter_mut().zip(sums);
        for ((residual, &sum), (row_scale, bias)) in rows.zip(scales.iter().zip(bias)) {
            *residual += sum as f32 * (scale * row_scale) + bias;
        }
    }

    #[inline]
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
        let Some(factors) = factors(absmax(values), limit) else {
            codes.fill(0);
            return 0.0;
        };
        for (code, &value) in codes.iter_mut().zip(values) {
            *code = round_to_even(value * factors.to_codes) as i16;
        }
        factors.to_values
    }

    #[inline]
    fn rectified_median(before: Sample, here: Sample, after: Sample) -> CleanSample {
        core::array::from_fn(|channel| {
            let (before, after) = (before[channel], after[channel]);
            let (low, high) = (before.min(after), before.max(after));
            here[channel].clamp(low, high).unsigned_abs()
        })
    }
}

/// Factors from values to codes and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    pub to_codes: f32,
    pub to_values: f32,
}

/// Factors for values up to `largest`; none if that counts as zero or is not finite.
#[inline]
pub(super) fn factors(largest: f32, limit: i16) -> Option<Factors> {
    let limit = f32::from(limit);
    // Twice rounded, `largest * (limit / largest)` is within 0.01 of `limit` <= 32767, so no
    // code leaves its range.
    (SMALLEST..=f32::MAX).contains(&largest).then(|| Factors {
        to_codes: limit / largest,
        to_values: largest / limit,
    })
}

/// Columns of a tile that are rearranged into rows at once.
const STRETCH: usize = 64;
/// Terms per chunk of the inner loop, which the compiler unrolls completely. Measured on x86-64, a row
/// of 64 takes half the time of chunks of 16 or of one loop.
const PIECE: usize = 32;

/// A tile's sums, computed by rows: the compiler turns them into vector code that multiplies and adds
/// pairs, four times as fast as the vector code for the tile's own order.
#[inline]
fn tile<const T: usize>(weights: &[i8], inputs: [&[i16]; T]) -> [[i32; TILE_ROWS]; T] {
    let mut sums = [[0; TILE_ROWS]; T];
    for (stretch, weights) in weights.chunks(TILE_ROWS * STRETCH).enumerate() {
        let mut rows = [[[0_i16; GROUP]; STRETCH / GROUP]; TILE_ROWS];
        let words = weights.as_chunks::<GROUP>().0.as_chunks::<TILE_ROWS>().0;
        for (group, words) in words.iter().enumerate() {
            for (row, word) in rows.iter_mut().zip(words) {
                row[group] = weights_of(*word);
            }
        }
        let columns = weights.len() / TILE_ROWS;
        for (sums, input) in sums.iter_mut().zip(inputs) {
            let input = &input[stretch * STRETCH..][..columns];
            for (sum, row) in sums.iter_mut().zip(&rows) {
                *sum += sum_of_products(&row.as_flattened()[..columns], input);
            }
        }
    }
    sums
}

#[inline]
fn sum_of_products(row: &[i16], input: &[i16]) -> i32 {
    let (row, row_rest) = row.as_chunks::<PIECE>();
    let (input, input_rest) = input.as_chunks::<PIECE>();
    let mut sum = 0;
    for (row, input) in row.iter().zip(input) {
        sum += products(row, input);
    }
    sum + products(row_rest, input_rest)
}

#[inline]
fn products(row: &[i16], input: &[i16]) -> i32 {
    row.iter()
        .zip(input)
        .map(|(&w, &x)| i32::from(w) * i32::from(x))
        .sum()
}
