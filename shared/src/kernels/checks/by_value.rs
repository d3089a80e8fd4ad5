//! Checks of the kernels that take values one by one: rescaling, quantization, median.

use alloc::vec::Vec;

use super::super::{Aligned, KEY_LIMIT, Kernels, MAX_COLUMNS, QUERY_LIMIT, portable::Portable};
use super::{Fill, value};
use crate::model::noise::Noise;
use crate::units::Sample;

/// Compares both kernels with the formula, whose order of operations is theirs, bit for bit; one more output than rows
/// stays as it is.
pub(super) fn rescale<K: Kernels>(rows: usize, fill: Fill, noise: &mut Noise) {
    let mut draw = |size: f32| -> Vec<f32> {
        let integer = |index| value(noise, fill, index, [-99_999, 99_999], [-99_999, 99_999]);
        (0..rows)
            .map(integer)
            .map(|value| value as f32 * size)
            .collect()
    };
    let [scales, bias, residual] = [1e-4, 1e-5, 1e-5].map(&mut draw);
    let sums: Vec<i32> = (0..rows)
        .map(|index| {
            value(
                noise,
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
            assert_eq!(found, expected, "{kernel} {rows} {fill:?} {row}");
        }
    }
}

/// Compares with the portable kernel, bit for bit, and with the formula in f64: a code may differ from it
/// by the error of two f32 roundings, and the largest value has the largest code.
pub(super) fn quantize<K: Kernels>(length: usize, fill: Fill, noise: &mut Noise) {
    let mut values = [0.0_f32; MAX_COLUMNS];
    let mut codes = Aligned([1_i16; MAX_COLUMNS]);
    let (values, codes) = (&mut values[..length], &mut codes.0[..length]);
    for (index, number) in values.iter_mut().enumerate() {
        let integer = value(noise, fill, index, [-99_999, 99_999], [-99_999, 99_999]);
        *number = integer as f32 * 1e-3;
    }
    let limit = [QUERY_LIMIT, KEY_LIMIT, i16::MAX][length % 3];
    let scale = quantize_as_portable::<K>(values, limit, codes);
    let mut largest = 0.0;
    for value in &*values {
        if value.abs() > largest {
            largest = value.abs();
        }
    }
    assert_eq!(scale, largest / f32::from(limit), "{length} {fill:?}");
    for (&value, &code) in values.iter().zip(&*codes) {
        let exact = f64::from(value) * f64::from(limit) / f64::from(largest.max(1e-30));
        assert!((exact - f64::from(code)).abs() <= 0.51, "{exact} {code}");
        let is_largest = value.abs() == largest && largest > 0.0;
        assert!(!is_largest || code.unsigned_abs() == limit.unsigned_abs());
    }
}

pub(super) fn quantize_special<K: Kernels>(values: [f32; 8]) {
    for limit in [QUERY_LIMIT, i16::MAX] {
        let mut codes = Aligned([1; 8]);
        quantize_as_portable::<K>(&values, limit, &mut codes.0);
    }
}

/// Compares codes and scale with the portable kernel's.
fn quantize_as_portable<K: Kernels>(values: &[f32], limit: i16, codes: &mut [i16]) -> f32 {
    let mut portable = [2_i16; MAX_COLUMNS];
    let portable = &mut portable[..values.len()];
    let scale = Portable::quantize(values, limit, portable);
    let found = K::quantize(values, limit, codes);
    assert_eq!(found.to_bits(), scale.to_bits(), "{values:?}");
    assert_eq!(codes, portable, "{values:?}");
    found
}

pub(super) fn rectified_median<K: Kernels>(fill: Fill, noise: &mut Noise) {
    let [before, here, after] = [0, 1, 2].map(|first: usize| {
        core::array::from_fn(|channel| {
            value(noise, fill, first + channel, [-128, 127], [-128, 127]) as i8
        })
    });
    let found = K::rectified_median(before, here, after);
    for (channel, found) in found.into_iter().enumerate() {
        let mut three = [before, here, after].map(|sample: Sample| i64::from(sample[channel]));
        three.sort_unstable();
        assert_eq!(i64::from(found), three[1].abs(), "{fill:?} {channel}");
    }
}
