//! Checks of any implementation of the kernels, for the PC and for the emulated core.
//!
//! References are naive and in i64. Lengths range from 0 to the largest; operands are extremes and
//! seeded noise.

mod by_value;

use alloc::vec::Vec;

use self::by_value::{quantize, quantize_special, rectified_median, rescale};

use super::{
    Aligned, KEY_LIMIT, Kernels, MAX_COLUMNS, MAX_TERMS, QUERY_LIMIT, code_limit, packing::packed,
    portable::Portable,
};
use crate::model::noise::Noise;

/// Content of the operands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Fill {
    /// All zeros.
    Zeros,
    /// The largest codes times the largest weights.
    Maxima,
    /// The smallest codes times the largest weights: the largest magnitude.
    Minima,
    /// The extremes alternating.
    Alternating,
    /// Uniform pseudo-random numbers over the whole range.
    Noise,
}

const FILLS: [Fill; 5] = [
    Fill::Zeros,
    Fill::Maxima,
    Fill::Minima,
    Fill::Alternating,
    Fill::Noise,
];
/// Columns of `multiply`: multiples of a group, with and without whole passes of the unrolled loop.
const COLUMNS: [usize; 13] = [0, 4, 8, 12, 16, 20, 32, 48, 64, 80, 124, 184, 504];
/// Rows of `multiply`: one tile and several.
const ROWS: [usize; 2] = [4, 12];
/// Terms of the products of codes.
const TERMS: [usize; 9] = [0, 1, 2, 4, 6, 12, 16, 27, MAX_TERMS];
/// Number of rows of these terms, or of columns, and of unused values between two rows.
const LAYOUTS: [(usize, usize); 6] = [(1, 0), (3, 4), (4, 0), (9, 4), (16, 5), (27, 1)];
/// Lengths of `quantize`.
const LENGTHS: [usize; 7] = [0, 1, 2, 7, 16, 127, MAX_COLUMNS];
/// Values that quantize to zero, and the smallest and largest that do not.
const SPECIAL: [[f32; 8]; 6] = [
    [f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -f32::NAN],
    [1.0, 2.0, f32::INFINITY, 3.0, 4.0, 5.0, 6.0, 7.0],
    [0.0, -0.0, f32::NEG_INFINITY, 0.0, -1.0, 1.0, 0.0, 0.0],
    [9e-31, -9e-31, 1e-38, 1e-45, 0.0, -0.0, 0.0, 0.0],
    [1e-30, -1e-30, 5e-31, 2.5e-31, 1e-38, 0.0, -0.0, 0.0],
    [
        f32::MAX,
        f32::MIN,
        1.0,
        -1.0,
        f32::MIN_POSITIVE,
        0.0,
        1e38,
        -1e38,
    ],
];
/// Random shapes with noise, for each kernel.
const DRAWS: usize = 10_000;
/// Most columns of a random shape: ten thousand take seconds on the emulated core.
const DRAWN_COLUMNS: usize = 96;
const MOST_ROWS: usize = 12;

/// Runs all checks on an implementation.
fn check<K: Kernels>() {
    let mut noise = Noise(0x2545_f491);
    for fill in FILLS {
        for columns in COLUMNS.into_iter().chain([MAX_COLUMNS]) {
            for rows in ROWS {
                multiply::<K, 1>(columns, rows, fill, &mut noise);
                multiply::<K, 2>(columns, rows, fill, &mut noise);
                multiply::<K, 3>(columns, rows, fill, &mut noise);
            }
        }
        for terms in TERMS {
            for (count, between) in LAYOUTS {
                row_products::<K>(terms, count, between, fill, &mut noise);
                weighted_rows::<K>(terms, count, between, fill, &mut noise);
            }
        }
        for length in LENGTHS {
            quantize::<K>(length, fill, &mut noise);
            rescale::<K>(length, fill, &mut noise);
        }
        rectified_median::<K>(fill, &mut noise);
    }
    for values in SPECIAL {
        quantize_special::<K>(values);
    }
    for _ in 0..DRAWS {
        let columns = 4 * below(&mut noise, DRAWN_COLUMNS / 4 + 1);
        let rows = 4 + 4 * below(&mut noise, MOST_ROWS / 4);
        match below(&mut noise, 2) {
            0 => multiply::<K, 1>(columns, rows, Fill::Noise, &mut noise),
            _ => multiply::<K, 2>(columns, rows, Fill::Noise, &mut noise),
        }
        let [terms, count, between] =
            [MAX_TERMS + 1, MAX_TERMS, 5].map(|most| below(&mut noise, most));
        row_products::<K>(terms, 1 + count, between, Fill::Noise, &mut noise);
        weighted_rows::<K>(terms, 1 + count, between, Fill::Noise, &mut noise);
        let length = 1 + below(&mut noise, DRAWN_COLUMNS);
        quantize::<K>(length, Fill::Noise, &mut noise);
        rescale::<K>(below(&mut noise, DRAWN_COLUMNS), Fill::Noise, &mut noise);
        rectified_median::<K>(Fill::Noise, &mut noise);
    }
}

fn multiply<K: Kernels, const T: usize>(
    columns: usize,
    rows: usize,
    fill: Fill,
    noise: &mut Noise,
) {
    let mut weights = Aligned([0_i8; MOST_ROWS * MAX_COLUMNS]);
    let mut inputs = [Aligned([0_i16; MAX_COLUMNS]); T];
    let weights = &mut weights.0[..rows * columns];
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight = value(noise, fill, index, [-128, 127], [127, 127]) as i8;
    }
    let limit = i32::from(code_limit(weights, columns));
    for input in &mut inputs {
        for (index, code) in input.0[..columns].iter_mut().enumerate() {
            *code = value(noise, fill, index, [-limit, limit], [-limit, limit]) as i16;
        }
    }
    let inputs = inputs.each_ref().map(|input| &input.0[..columns]);
    let mut sums = [[i32::MIN; MOST_ROWS]; T];
    K::multiply(
        weights,
        inputs,
        sums.each_mut().map(|sums| &mut sums[..rows]),
    );
    for (input, sums) in inputs.iter().zip(sums) {
        for (row, &found) in sums[..rows].iter().enumerate() {
            let weight = |column| weight_in_tiles(weights, row, column, columns);
            let products = (0..columns).map(|column| weight(column) * i64::from(input[column]));
            let expected: i64 = products.sum();
            assert_eq!(
                i64::from(found),
                expected,
                "multiply {columns} {fill:?} {row}"
            );
        }
    }
}

/// A weight: 256 times its byte, and the byte before it in its word of four.
fn weight_in_tiles(tiles: &[i8], row: usize, column: usize, columns: usize) -> i64 {
    let index = index_in_tiles(row, column, columns);
    let before = if index.is_multiple_of(4) {
        0
    } else {
        tiles[index - 1].cast_unsigned()
    };
    256 * i64::from(tiles[index]) + i64::from(before)
}

/// Index of a weight in the tiles of [`Kernels::multiply`].
fn index_in_tiles(row: usize, column: usize, columns: usize) -> usize {
    let byte = [0, 2, 1, 3][column % 4];
    row / 4 * 4 * columns + column / 4 * 16 + row % 4 * 4 + byte
}

/// Operands of the two products of codes: a single row, and rows with unused values between.
struct Operands {
    single: Aligned<[i16; MAX_TERMS]>,
    rows: Aligned<[i16; 2 * MAX_TERMS * MAX_TERMS + 8 * MAX_TERMS]>,
}

impl Operands {
    fn new(fill: Fill, noise: &mut Noise) -> Self {
        let [single, rows] = [QUERY_LIMIT, KEY_LIMIT].map(i32::from);
        let mut operands = Self {
            single: Aligned([0; _]),
            rows: Aligned([0; _]),
        };
        for (index, code) in operands.single.0.iter_mut().enumerate() {
            *code = value(noise, fill, index, [-single, single], [single, single]) as i16;
        }
        for (index, code) in operands.rows.0.iter_mut().enumerate() {
            *code = value(noise, fill, index, [-rows, rows], [-rows, rows]) as i16;
        }
        operands
    }
}

fn row_products<K: Kernels>(
    terms: usize,
    count: usize,
    between: usize,
    fill: Fill,
    noise: &mut Noise,
) {
    let operands = Operands::new(fill, noise);
    let (query, rows) = (&operands.single.0[..terms], &operands.rows.0);
    let stride = (terms + between).max(1);
    let mut sums = [i32::MIN; MAX_TERMS];
    K::row_products(query, rows, stride, &mut sums[..count]);
    for (row, &found) in sums[..count].iter().enumerate() {
        let pairs = query.iter().zip(&rows[row * stride..]);
        let expected: i64 = pairs.map(|(&a, &b)| i64::from(a) * i64::from(b)).sum();
        assert_eq!(
            i64::from(found),
            expected,
            "row_products {terms} {fill:?} {row}"
        );
    }
}

fn weighted_rows<K: Kernels>(
    terms: usize,
    columns: usize,
    between: usize,
    fill: Fill,
    noise: &mut Noise,
) {
    let operands = Operands::new(fill, noise);
    let (weights, rows) = (&operands.single.0[..terms], &operands.rows.0);
    let stride = columns + between;
    let mut sums = [i32::MIN; MAX_TERMS];
    K::weighted_rows(weights, rows, stride, &mut sums[..columns]);
    for (column, &found) in sums[..columns].iter().enumerate() {
        let values = (0..terms).map(|row| i64::from(rows[row * stride + column]));
        let products = weights.iter().zip(values);
        let expected: i64 = products.map(|(&w, v)| i64::from(w) * v).sum();
        assert_eq!(
            i64::from(found),
            expected,
            "weighted_rows {terms} {fill:?} {column}"
        );
    }
}

/// A number below `most`.
fn below(noise: &mut Noise, most: usize) -> usize {
    (noise.bits() % most as u64) as usize
}

/// A value; `range` is for noise and alternation, `extremes` are for minima and maxima.
fn value(noise: &mut Noise, fill: Fill, index: usize, range: [i32; 2], extremes: [i32; 2]) -> i32 {
    match fill {
        Fill::Zeros => 0,
        Fill::Minima => extremes[0],
        Fill::Maxima => extremes[1],
        Fill::Alternating => range[index % 2],
        Fill::Noise => range[0] + (noise.bits() as u32 % (range[1] - range[0] + 1) as u32) as i32,
    }
}

#[test]
fn the_portable_kernels_pass_the_checks() {
    check::<Portable>();
}

#[test]
fn the_kernels_of_this_target_pass_the_checks() {
    check::<super::Active>();
}

#[test]
fn tiles_are_those_of_packing() {
    for (rows, columns) in [(1, 4), (5, 8), (11, 16)] {
        let matrix: Vec<i8> = (0..rows * columns).map(|index| index as i8).collect();
        let tiles = packed(&matrix, columns);
        for index in 0..rows * columns {
            let found = tiles[index_in_tiles(index / columns, index % columns, columns)];
            assert_eq!(found, matrix[index]);
        }
    }
}
