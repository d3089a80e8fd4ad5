//! Checks of any implementation of the kernels, for the PC and for the emulated core.
//!
//! References are naive and in i64. Lengths range from 0 to the largest; operands are extremes and
//! seeded noise.

use alloc::vec::Vec;

use super::{
    Aligned, KEY_LIMIT, Kernels, MAX_COLUMNS, MAX_TERMS, QUERY_LIMIT, code_limit, packing::packed,
    portable::Portable,
};
use crate::units::{CleanSample, Sample};

/// A kernel differs from its reference.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Mismatch {
    /// The kernel.
    kernel: &'static str,
    /// Length of the rows.
    length: usize,
    /// Their content.
    fill: Fill,
    /// Index of the output.
    row: usize,
    /// The reference's result.
    expected: i64,
    /// The kernel's result.
    found: i64,
}

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
    /// Infinities, NaN and the smallest numbers.
    Special,
}

const FILLS: [Fill; 5] = [
    Fill::Zeros,
    Fill::Maxima,
    Fill::Minima,
    Fill::Alternating,
    Fill::Noise,
];
/// Columns of `multiply`: multiples of a group, with and without whole passes of the unrolled loop.
const COLUMNS: [usize; 14] = [
    0,
    4,
    8,
    12,
    16,
    20,
    32,
    48,
    64,
    80,
    124,
    184,
    504,
    MAX_COLUMNS,
];
/// Rows of `multiply`: one tile and several.
const ROWS: [usize; 2] = [4, 12];
/// Most tokens of `multiply` that are tried.
const MOST_TOKENS: usize = 3;
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

/// Kernel calls in one [`check`].
const CASES: usize = 6 * DRAWS
    + SPECIAL.len()
    + FILLS.len()
        * (MOST_TOKENS * COLUMNS.len() * ROWS.len()
            + 2 * TERMS.len() * LAYOUTS.len()
            + 2 * LENGTHS.len()
            + 1);

/// Runs all checks on an implementation and returns their number.
///
/// # Errors
///
/// The first difference.
fn check<K: Kernels>() -> Result<usize, Mismatch> {
    let mut checked = 0;
    let mut noise = Noise(0x2545_f491);
    for fill in FILLS {
        for columns in COLUMNS {
            for rows in ROWS {
                checked += multiply::<K, 1>(columns, rows, fill, &mut noise)?;
                checked += multiply::<K, 2>(columns, rows, fill, &mut noise)?;
                checked += multiply::<K, MOST_TOKENS>(columns, rows, fill, &mut noise)?;
            }
        }
        for terms in TERMS {
            for (count, between) in LAYOUTS {
                checked += row_products::<K>(terms, count, between, fill, &mut noise)?;
                checked += weighted_rows::<K>(terms, count, between, fill, &mut noise)?;
            }
        }
        for length in LENGTHS {
            checked += quantize::<K>(length, fill, &mut noise)?;
            checked += rescale::<K>(length, fill, &mut noise)?;
        }
        checked += rectified_median::<K>(fill, &mut noise)?;
    }
    for values in SPECIAL {
        checked += quantize_special::<K>(values)?;
    }
    for _ in 0..DRAWS {
        let columns = 4 * noise.below(DRAWN_COLUMNS / 4 + 1);
        let rows = 4 + 4 * noise.below(MOST_ROWS / 4);
        checked += match noise.below(2) {
            0 => multiply::<K, 1>(columns, rows, Fill::Noise, &mut noise)?,
            _ => multiply::<K, 2>(columns, rows, Fill::Noise, &mut noise)?,
        };
        let [terms, count, between] = [MAX_TERMS + 1, MAX_TERMS, 5].map(|most| noise.below(most));
        checked += row_products::<K>(terms, 1 + count, between, Fill::Noise, &mut noise)?;
        checked += weighted_rows::<K>(terms, 1 + count, between, Fill::Noise, &mut noise)?;
        checked += quantize::<K>(1 + noise.below(DRAWN_COLUMNS), Fill::Noise, &mut noise)?;
        checked += rescale::<K>(noise.below(DRAWN_COLUMNS), Fill::Noise, &mut noise)?;
        checked += rectified_median::<K>(Fill::Noise, &mut noise)?;
    }
    Ok(checked)
}

fn multiply<K: Kernels, const T: usize>(
    columns: usize,
    rows: usize,
    fill: Fill,
    noise: &mut Noise,
) -> Result<usize, Mismatch> {
    let mut weights = Aligned([0_i8; MOST_ROWS * MAX_COLUMNS]);
    let mut inputs = [Aligned([0_i16; MAX_COLUMNS]); T];
    let weights = &mut weights.0[..rows * columns];
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight = noise.value(fill, index, [-128, 127], [127, 127]) as i8;
    }
    let limit = i32::from(code_limit(weights, columns));
    for input in &mut inputs {
        for (index, code) in input.0[..columns].iter_mut().enumerate() {
            *code = noise.value(fill, index, [-limit, limit], [-limit, limit]) as i16;
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
            let expected = (0..columns)
                .map(|column| {
                    weight_in_tiles(weights, row, column, columns) * i64::from(input[column])
                })
                .sum();
            agree(Mismatch {
                kernel: "multiply",
                length: columns,
                fill,
                row,
                expected,
                found: i64::from(found),
            })?;
        }
    }
    Ok(1)
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
            *code = noise.value(fill, index, [-single, single], [single, single]) as i16;
        }
        for (index, code) in operands.rows.0.iter_mut().enumerate() {
            *code = noise.value(fill, index, [-rows, rows], [-rows, rows]) as i16;
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
) -> Result<usize, Mismatch> {
    let operands = Operands::new(fill, noise);
    let (query, rows) = (&operands.single.0[..terms], &operands.rows.0);
    let stride = (terms + between).max(1);
    let mut sums = [i32::MIN; MAX_TERMS];
    K::row_products(query, rows, stride, &mut sums[..count]);
    for (row, &found) in sums[..count].iter().enumerate() {
        let pairs = query.iter().zip(&rows[row * stride..]);
        agree(Mismatch {
            kernel: "row_products",
            length: terms,
            fill,
            row,
            expected: pairs.map(|(&a, &b)| i64::from(a) * i64::from(b)).sum(),
            found: i64::from(found),
        })?;
    }
    Ok(1)
}

fn weighted_rows<K: Kernels>(
    terms: usize,
    columns: usize,
    between: usize,
    fill: Fill,
    noise: &mut Noise,
) -> Result<usize, Mismatch> {
    let operands = Operands::new(fill, noise);
    let (weights, rows) = (&operands.single.0[..terms], &operands.rows.0);
    let stride = columns + between;
    let mut sums = [i32::MIN; MAX_TERMS];
    K::weighted_rows(weights, rows, stride, &mut sums[..columns]);
    for (column, &found) in sums[..columns].iter().enumerate() {
        let values = (0..terms).map(|row| i64::from(rows[row * stride + column]));
        let products = weights.iter().zip(values);
        agree(Mismatch {
            kernel: "weighted_rows",
            length: terms,
            fill,
            row: column,
            expected: products.map(|(&w, v)| i64::from(w) * v).sum(),
            found: i64::from(found),
        })?;
    }
    Ok(1)
}

/// Compares both kernels with the formula, whose order of operations is theirs, bit for bit; one more output than rows
/// stays as it is.
fn rescale<K: Kernels>(rows: usize, fill: Fill, noise: &mut Noise) -> Result<usize, Mismatch> {
    let mut draw = |size: f32| -> Vec<f32> {
        let integer = |index| noise.value(fill, index, [-99_999, 99_999], [-99_999, 99_999]);
        (0..rows)
            .map(integer)
            .map(|value| value as f32 * size)
            .collect()
    };
    let [scales, bias, residual] = [1e-4, 1e-5, 1e-5].map(&mut draw);
    let sums: Vec<i32> = (0..rows)
        .map(|index| {
            noise.value(
                fill,
                index,
                [-0x3fff_ffff, 0x3fff_ffff],
                [i32::MIN, i32::MAX],
            )
        })
        .collect();
    let scale = 3e-8_f32;
    let mut outputs: Vec<f32> = sums
        .iter()
        .chain(&[7])
        .map(|sum| f32::from_bits(sum.cast_unsigned()))
        .collect();
    let mut added = residual.clone();
    K::rescale(&mut outputs, scale, &scales, &bias);
    K::add_rescaled(&sums, scale, &scales, &bias, &mut added);
    for row in 0..=rows {
        let bits = |value: f32| i64::from(value.to_bits());
        let pairs = if row == rows {
            [(7, bits(outputs[row])), (0, 0)]
        } else {
            let value = sums[row] as f32 * (scale * scales[row]) + bias[row];
            let sum = residual[row] + value;
            [
                (bits(value), bits(outputs[row])),
                (bits(sum), bits(added[row])),
            ]
        };
        for (kernel, (expected, found)) in ["rescale", "add_rescaled"].into_iter().zip(pairs) {
            agree(Mismatch {
                kernel,
                length: rows,
                fill,
                row,
                expected,
                found,
            })?;
        }
    }
    Ok(1)
}

/// Compares with the portable kernel, bit for bit, and with the formula in f64: a code may differ from it
/// by the error of two f32 roundings, and the largest value has the largest code.
fn quantize<K: Kernels>(length: usize, fill: Fill, noise: &mut Noise) -> Result<usize, Mismatch> {
    let mut values = [0.0_f32; MAX_COLUMNS];
    let mut codes = Aligned([1_i16; MAX_COLUMNS]);
    let (values, codes) = (&mut values[..length], &mut codes.0[..length]);
    for (index, value) in values.iter_mut().enumerate() {
        let integer = noise.value(fill, index, [-99_999, 99_999], [-99_999, 99_999]);
        *value = integer as f32 * 1e-3;
    }
    let limit = [QUERY_LIMIT, KEY_LIMIT, i16::MAX][length % 3];
    let scale = quantize_as_portable::<K>(values, limit, codes, fill)?;
    let mut largest = 0.0;
    for value in &*values {
        if value.abs() > largest {
            largest = value.abs();
        }
    }
    let mismatch = |row, expected: f32, found: f32| Mismatch {
        kernel: "quantize",
        length,
        fill,
        row,
        expected: i64::from(expected.to_bits()),
        found: i64::from(found.to_bits()),
    };
    agree(mismatch(0, largest / f32::from(limit), scale))?;
    for (row, (&value, &code)) in values.iter().zip(&*codes).enumerate() {
        let exact = f64::from(value) * f64::from(limit) / f64::from(largest.max(1e-30));
        let distance = exact - f64::from(code);
        let is_largest = value.abs() == largest && largest > 0.0;
        if distance.abs() > 0.51 || (is_largest && code.unsigned_abs() != limit.unsigned_abs()) {
            return Err(mismatch(row, exact as f32, f32::from(code)));
        }
    }
    Ok(1)
}

fn quantize_special<K: Kernels>(values: [f32; 8]) -> Result<usize, Mismatch> {
    for limit in [QUERY_LIMIT, i16::MAX] {
        let mut codes = Aligned([1; 8]);
        quantize_as_portable::<K>(&values, limit, &mut codes.0, Fill::Special)?;
    }
    Ok(1)
}

/// Compares codes and scale with those of the portable kernel.
fn quantize_as_portable<K: Kernels>(
    values: &[f32],
    limit: i16,
    codes: &mut [i16],
    fill: Fill,
) -> Result<f32, Mismatch> {
    let mut portable = [2_i16; MAX_COLUMNS];
    let portable = &mut portable[..values.len()];
    let scales = [
        Portable::quantize(values, limit, portable),
        K::quantize(values, limit, codes),
    ];
    let pairs = portable.iter().zip(&*codes);
    let pairs = pairs.map(|(&expected, &found)| [i64::from(expected), i64::from(found)]);
    let bits = scales.map(|scale| i64::from(scale.to_bits()));
    for (row, [expected, found]) in core::iter::once(bits).chain(pairs).enumerate() {
        agree(Mismatch {
            kernel: "quantize",
            length: values.len(),
            fill,
            row,
            expected,
            found,
        })?;
    }
    Ok(scales[1])
}

fn rectified_median<K: Kernels>(fill: Fill, noise: &mut Noise) -> Result<usize, Mismatch> {
    let [before, here, after] = [0, 1, 2].map(|first: usize| {
        core::array::from_fn(|channel| {
            noise.value(fill, first + channel, [-128, 127], [-128, 127]) as i8
        })
    });
    let found = K::rectified_median(before, here, after);
    for (channel, found) in found.into_iter().enumerate() {
        let mut three = [before, here, after].map(|sample: Sample| i64::from(sample[channel]));
        three.sort_unstable();
        agree(Mismatch {
            kernel: "rectified_median",
            length: 3,
            fill,
            row: channel,
            expected: three[1].abs(),
            found: i64::from(found),
        })?;
    }
    Ok(1)
}

fn agree(pair: Mismatch) -> Result<(), Mismatch> {
    if pair.expected == pair.found {
        Ok(())
    } else {
        Err(pair)
    }
}

/// Marsaglia's xorshift generator: the same operands on every machine.
struct Noise(u32);

impl Noise {
    fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    fn below(&mut self, most: usize) -> usize {
        self.bits() as usize % most
    }

    /// A value; `range` is that of noise and of alternation, `extremes` are those of minima and maxima.
    fn value(&mut self, fill: Fill, index: usize, range: [i32; 2], extremes: [i32; 2]) -> i32 {
        match fill {
            Fill::Zeros => 0,
            Fill::Minima => extremes[0],
            Fill::Maxima => extremes[1],
            Fill::Alternating => range[index % 2],
            Fill::Noise | Fill::Special => {
                range[0] + (self.bits() % (range[1] - range[0] + 1) as u32) as i32
            }
        }
    }
}

/// Omits the last term of an odd number, as a faulty loop over pairs would.
struct DropsTheTail;

impl Kernels for DropsTheTail {
    fn multiply<const T: usize>(weights: &[i8], inputs: [&[i16]; T], sums: [&mut [i32]; T]) {
        Portable::multiply(weights, inputs, sums);
    }
    fn row_products(codes: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        Portable::row_products(&codes[..codes.len() / 2 * 2], rows, stride, sums);
    }
    fn weighted_rows(weights: &[i16], rows: &[i16], stride: usize, sums: &mut [i32]) {
        Portable::weighted_rows(weights, rows, stride, sums);
    }
    fn rescale(outputs: &mut [f32], scale: f32, scales: &[f32], bias: &[f32]) {
        Portable::rescale(outputs, scale, scales, bias);
    }
    fn add_rescaled(sums: &[i32], scale: f32, scales: &[f32], bias: &[f32], residual: &mut [f32]) {
        Portable::add_rescaled(sums, scale, scales, bias, residual);
    }
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
        Portable::quantize(values, limit, codes)
    }
    fn rectified_median(before: Sample, here: Sample, after: Sample) -> CleanSample {
        Portable::rectified_median(before, here, after)
    }
}

#[test]
fn the_portable_kernels_pass_the_checks() {
    assert_eq!(check::<Portable>(), Ok(CASES));
}

#[cfg(cortex_m4)]
#[test]
fn the_dsp_kernels_pass_the_checks() {
    assert_eq!(check::<super::cortex_m4::CortexM4>(), Ok(CASES));
}

#[test]
fn a_dropped_tail_is_detected() {
    let mismatch = check::<DropsTheTail>().unwrap_err();
    assert_eq!((mismatch.kernel, mismatch.length), ("row_products", 1));
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
