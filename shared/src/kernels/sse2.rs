//! The products of integers with the SSE2 instructions that every x86-64 has, `PMADDWD` above all.
//!
//! Equal to [`Portable`] bit for bit: sums of integers have no order. Written out because the compiler does not find
//! `PMADDWD` in the order of a tile. Registers are loaded from arrays, so no address has to be aligned.

#![allow(unsafe_code, reason = "the kernels are the one place for it")]

use core::arch::x86_64::{
    __m128i, _mm_add_epi32, _mm_madd_epi16, _mm_set1_epi32, _mm_set1_epi64x, _mm_setzero_si128,
    _mm_shuffle_epi32, _mm_slli_epi32, _mm_unpackhi_epi16, _mm_unpackhi_epi32, _mm_unpackhi_epi64,
    _mm_unpacklo_epi16, _mm_unpacklo_epi32, _mm_unpacklo_epi64,
};

use bytemuck::cast;

use super::portable::Portable;
use super::{GROUP, Kernels, TILE_ROWS};
use crate::units::{CleanSample, Sample};

/// The kernels of an x86-64.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sse2;

/// Codes of a register.
const CODES: usize = 8;
/// Tiles that are multiplied at once: the codes are spread over registers once for all of them.
const TILES: usize = 4;
/// Words of a group of columns, one for each row of a tile: a register.
type Words = [i8; TILE_ROWS * GROUP];

impl Kernels for Sse2 {
    #[inline]
    fn multiply<const T: usize>(weights: &[i8], inputs: [&[i16]; T], sums: [&mut [i32]; T]) {
        for (input, sums) in inputs.into_iter().zip(sums) {
            // SAFETY: every x86-64 has SSE2.
            unsafe { multiply(weights.as_chunks().0, input.as_chunks().0, sums) };
        }
    }

    #[inline]
    fn row_products(codes: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        // SAFETY: every x86-64 has SSE2.
        unsafe {
            match codes.as_chunks() {
                (&[a], []) => row_products([a], rows, stride, sums),
                (&[a, b], []) => row_products([a, b], rows, stride, sums),
                (&[a, b, c], []) => row_products([a, b, c], rows, stride, sums),
                (&[a, b, c, d], []) => row_products([a, b, c, d], rows, stride, sums),
                _ => Portable::row_products(codes, rows, stride, sums),
            }
        }
    }

    #[inline]
    fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        let (registers, []) = sums.as_chunks_mut() else {
            return Portable::weighted_rows(weights, rows, stride, sums);
        };
        for (place, sums) in registers.iter_mut().enumerate() {
            // SAFETY: every x86-64 has SSE2.
            *sums = unsafe { weighted_rows(weights, &rows[place * CODES..], stride) };
        }
    }

    #[inline]
    fn rescale(outputs: &mut [f32], scale: f32, scales: &[f32], bias: &[f32]) {
        Portable::rescale(outputs, scale, scales, bias);
    }

    #[inline]
    fn add_rescaled(sums: &[i32], scale: f32, scales: &[f32], bias: &[f32], residual: &mut [f32]) {
        Portable::add_rescaled(sums, scale, scales, bias, residual);
    }

    #[inline]
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
        Portable::quantize(values, limit, codes)
    }

    #[inline]
    fn rectified_median(before: Sample, here: Sample, after: Sample) -> CleanSample {
        Portable::rectified_median(before, here, after)
    }
}

/// [`Kernels::multiply`] of one token.
#[inline]
#[target_feature(enable = "sse2")]
fn multiply(mut weights: &[Words], codes: &[[i16; GROUP]], sums: &mut [i32]) {
    let (blocks, rest) = sums.as_chunks_mut().0.as_chunks_mut::<TILES>();
    for sums in blocks {
        *sums = tiles(&mut weights, codes);
    }
    for sums in rest {
        [*sums] = tiles(&mut weights, codes);
    }
}

/// Takes `N` tiles off the weights, and returns the sums of their rows.
#[inline]
#[target_feature(enable = "sse2")]
fn tiles<const N: usize>(weights: &mut &[Words], codes: &[[i16; GROUP]]) -> [[i32; TILE_ROWS]; N] {
    let tiles: [&[Words]; N] = core::array::from_fn(|_| {
        let (tile, rest) = weights.split_at(codes.len());
        *weights = rest;
        tile
    });
    let mut sums = [_mm_setzero_si128(); N];
    for (group, &codes) in codes.iter().enumerate() {
        let codes = _mm_set1_epi64x(cast(codes));
        let first = _mm_shuffle_epi32::<0b00_00_00_00>(codes);
        let last = _mm_shuffle_epi32::<0b01_01_01_01>(codes);
        for (sum, tile) in sums.iter_mut().zip(tiles) {
            // As in `weights_of`: a word holds the weights of the last two columns, shifted those of the first two.
            let words = cast(tile[group]);
            let of_last = _mm_madd_epi16(words, last);
            let of_first = _mm_madd_epi16(_mm_slli_epi32::<8>(words), first);
            *sum = _mm_add_epi32(*sum, _mm_add_epi32(of_first, of_last));
        }
    }
    sums.map(cast)
}

/// [`Kernels::row_products`] of `N` registers of codes.
#[inline]
#[target_feature(enable = "sse2")]
fn row_products<const N: usize>(
    codes: [[i16; CODES]; N],
    rows: &[i16],
    stride: usize,
    sums: &mut [i32],
) {
    let codes: [__m128i; N] = codes.map(cast);
    let mut rows = rows.chunks(stride);
    // Four sums, which are to be added.
    let mut next = || {
        let row = rows.next().and_then(|row| row.as_chunks().0.first_chunk());
        let row: [[i16; CODES]; N] = row.copied().unwrap_or([[0; CODES]; N]);
        let mut sum = _mm_setzero_si128();
        for (row, codes) in row.into_iter().zip(codes) {
            sum = _mm_add_epi32(sum, _mm_madd_epi16(codes, cast(row)));
        }
        sum
    };
    let (fours, rest) = sums.as_chunks_mut::<4>();
    for sums in fours {
        let [a, b, c, d] = [next(), next(), next(), next()];
        let ab = _mm_add_epi32(_mm_unpacklo_epi32(a, b), _mm_unpackhi_epi32(a, b));
        let cd = _mm_add_epi32(_mm_unpacklo_epi32(c, d), _mm_unpackhi_epi32(c, d));
        *sums = cast(_mm_add_epi32(
            _mm_unpacklo_epi64(ab, cd),
            _mm_unpackhi_epi64(ab, cd),
        ));
    }
    for sum in rest {
        *sum = cast::<_, [i32; 4]>(next()).iter().sum();
    }
}

/// [`Kernels::weighted_rows`] of the columns of a register.
#[inline]
#[target_feature(enable = "sse2")]
fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize) -> [i32; CODES] {
    let [mut low, mut high] = [_mm_setzero_si128(); 2];
    for (pair, weights) in weights.chunks(2).enumerate() {
        let row = |row: usize| {
            let row = rows[(2 * pair + row) * stride..].first_chunk::<CODES>();
            row.map_or(_mm_setzero_si128(), |&row| cast(row))
        };
        let (a, b, weights) = match *weights {
            [a, b] => (row(0), row(1), [a, b]),
            [a, ..] => (row(0), row(0), [a, 0]),
            [] => break,
        };
        let weights = _mm_set1_epi32(cast(weights));
        low = _mm_add_epi32(low, _mm_madd_epi16(_mm_unpacklo_epi16(a, b), weights));
        high = _mm_add_epi32(high, _mm_madd_epi16(_mm_unpackhi_epi16(a, b), weights));
    }
    cast([low, high])
}
