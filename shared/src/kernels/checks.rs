//! One catalogue that judges every form of the kernels, on the PC and on the core.
//!
//! Naive twins in i64, lengths from nothing to the longest, extremes and seeded noise.

use super::{KEY_LIMIT, Kernels, MAX_COLUMNS, MAX_TERMS, QUERY_LIMIT, TOKEN_LIMIT};

/// A kernel and its twin disagree.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[error("{kernel}, length {length}, fill {fill:?}, row {row}: {found}, expected {expected}")]
pub struct Mismatch {
    /// Which kernel.
    pub kernel: &'static str,
    /// Length of the rows.
    pub length: usize,
    /// What they were filled with.
    pub fill: Fill,
    /// Which output.
    pub row: usize,
    /// The twin's result.
    pub expected: i64,
    /// The kernel's result.
    pub found: i64,
}

/// What operands are filled with.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fill {
    /// All zeros.
    Zeros,
    /// The largest codes times the largest weights.
    Maxima,
    /// The smallest codes times the largest weights: the largest magnitude of all.
    Minima,
    /// The extremes by turns.
    Alternating,
    /// Uniform over the whole range.
    Noise,
}

const FILLS: [Fill; 5] = [
    Fill::Zeros,
    Fill::Maxima,
    Fill::Minima,
    Fill::Alternating,
    Fill::Noise,
];
/// Row lengths of `multiply`; the terms of `dot` and `quantize` are those that fit.
const LENGTHS: [usize; 17] = [
    0,
    1,
    2,
    3,
    4,
    5,
    7,
    8,
    15,
    16,
    27,
    31,
    32,
    80,
    127,
    511,
    MAX_COLUMNS,
];
/// Rows of `multiply`: odd, so that forms that take rows in pairs have one left.
const ROWS: usize = 5;
const SHORT: usize = 13;

/// Judgements of one call of [`judge`].
pub const CASES: usize = FILLS.len() * (LENGTHS.len() * ROWS + SHORT + LENGTHS.len());

const _: () = assert!(LENGTHS[SHORT - 1] == MAX_TERMS);

/// Judges a form by the whole catalogue and counts the judgements.
///
/// # Errors
///
/// The first disagreement.
pub fn judge<K: Kernels>() -> Result<usize, Mismatch> {
    let mut judged = 0;
    let mut noise = Noise(0x2545_f491);
    for fill in FILLS {
        for length in LENGTHS {
            judged += multiply::<K>(length, fill, &mut noise)?;
            judged += quantize::<K>(length, fill, &mut noise)?;
        }
        for &length in &LENGTHS[..SHORT] {
            judged += dot::<K>(length, fill, &mut noise)?;
        }
    }
    Ok(judged)
}

fn multiply<K: Kernels>(length: usize, fill: Fill, noise: &mut Noise) -> Result<usize, Mismatch> {
    let mut weights = [0_i8; ROWS * MAX_COLUMNS];
    let mut input = [0_i16; MAX_COLUMNS];
    let weights = &mut weights[..ROWS * length];
    let input = &mut input[..length];
    for (index, weight) in weights.iter_mut().enumerate() {
        *weight = noise.value(fill, index, [-127, 127], [127, 127]) as i8;
    }
    for (index, code) in input.iter_mut().enumerate() {
        *code = noise.value(fill, index, [-32_768, 32_767], [-32_768, 32_767]) as i16;
    }
    let mut outputs = [i32::MIN; ROWS];
    K::multiply(weights, input, &mut outputs);
    for (row, &found) in outputs.iter().enumerate() {
        let weights = &weights[row * length..(row + 1) * length];
        let expected = weights
            .iter()
            .zip(&*input)
            .map(|(&w, &x)| i64::from(w) * i64::from(x))
            .sum();
        let found = i64::from(found);
        agree(Mismatch {
            kernel: "multiply",
            length,
            fill,
            row,
            expected,
            found,
        })?;
    }
    Ok(ROWS)
}

fn dot<K: Kernels>(length: usize, fill: Fill, noise: &mut Noise) -> Result<usize, Mismatch> {
    let [mut a, mut b] = [[0_i16; MAX_TERMS]; 2];
    let [query, key] = [QUERY_LIMIT, KEY_LIMIT].map(i32::from);
    for index in 0..length {
        a[index] = noise.value(fill, index, [-query, query], [query, query]) as i16;
        b[index] = noise.value(fill, index, [-key, key], [-key, key]) as i16;
    }
    let (a, b) = (&a[..length], &b[..length]);
    let expected = a
        .iter()
        .zip(b)
        .map(|(&a, &b)| i64::from(a) * i64::from(b))
        .sum();
    let found = i64::from(K::dot(a, b));
    agree(Mismatch {
        kernel: "dot",
        length,
        fill,
        row: 0,
        expected,
        found,
    })?;
    Ok(1)
}

/// Against the formula in f64: a code may differ from it only where the two f32 roundings can
/// carry it, and the largest value has the largest code.
fn quantize<K: Kernels>(length: usize, fill: Fill, noise: &mut Noise) -> Result<usize, Mismatch> {
    let mut values = [0.0_f32; MAX_COLUMNS];
    let mut codes = [1_i16; MAX_COLUMNS];
    let (values, codes) = (&mut values[..length], &mut codes[..length]);
    for (index, value) in values.iter_mut().enumerate() {
        let integer = noise.value(fill, index, [-99_999, 99_999], [-99_999, 99_999]);
        *value = integer as f32 * 1e-3;
    }
    let limit = [QUERY_LIMIT, KEY_LIMIT, TOKEN_LIMIT][length % 3];
    let scale = K::quantize(values, limit, codes);
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

fn agree(pair: Mismatch) -> Result<(), Mismatch> {
    if pair.expected == pair.found {
        Ok(())
    } else {
        Err(pair)
    }
}

/// Marsaglia's xorshift: the same operands on every machine.
struct Noise(u32);

impl Noise {
    /// `range` is that of noise and of alternation; `maxima` are the values of the two extremes.
    fn value(&mut self, fill: Fill, index: usize, range: [i32; 2], extremes: [i32; 2]) -> i32 {
        match fill {
            Fill::Zeros => 0,
            Fill::Minima => extremes[0],
            Fill::Maxima => extremes[1],
            Fill::Alternating => range[index % 2],
            Fill::Noise => {
                self.0 ^= self.0 << 13;
                self.0 ^= self.0 >> 17;
                self.0 ^= self.0 << 5;
                range[0] + (self.0 % (range[1] - range[0] + 1) as u32) as i32
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::portable::Portable;

    /// Forgets the last term of a row of odd length, the classic slip of a paired loop.
    struct DropsTheTail;

    impl Kernels for DropsTheTail {
        fn multiply(weights: &[i8], input: &[i16], outputs: &mut [i32]) {
            Portable::multiply(weights, input, outputs);
        }
        fn dot(a: &[i16], b: &[i16]) -> i32 {
            Portable::dot(&a[..a.len() / 2 * 2], b)
        }
        fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
            Portable::quantize(values, limit, codes)
        }
    }

    #[test]
    fn the_catalogue_catches_a_dropped_tail() {
        let mismatch = judge::<DropsTheTail>().unwrap_err();
        assert_eq!((mismatch.kernel, mismatch.length), ("dot", 1));
    }
}
