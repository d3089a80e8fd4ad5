//! The few float functions of the encoder and the smoother, in one fixed order of operations.
//!
//! Every one is made of single IEEE additions, multiplications and bit moves: no platform libm and
//! no fused multiply-add, so every bit agrees on x86-64 and on a Cortex-M4F. The order is part of
//! each function's meaning; do not rearrange it.

use micromath::F32Ext;

/// Above this [`exp`] is infinite: the largest multiple of 8 whose power of two fits one exponent.
const EXP_MAX: f32 = 88.0;
/// Below this [`exp`] is zero: what is left out is under 1.7e-38.
const EXP_MIN: f32 = -87.0;
/// ln 2 = `LN2_HIGH` + `LN2_LOW`; the first has 9 significant bits, so its product with the
/// integer power (8 bits) is exact.
const LN2_HIGH: f32 = 355.0 / 512.0;
const LN2_LOW: f32 = -2.121_944_4e-4;

/// e to the power `x`, relative error at most 1.5e-7.
///
/// Infinite above 88, zero below -87, NaN for NaN. `x` = n ln 2 + r with |r| <= 0.35; e^r is its
/// Taylor series to the seventh power (r^8 / 8! is 5e-9), 2^n a bit pattern.
#[must_use]
pub fn exp(x: f32) -> f32 {
    if x > EXP_MAX {
        return f32::INFINITY;
    }
    if x < EXP_MIN {
        return 0.0;
    }
    let power = round(x * core::f32::consts::LOG2_E);
    let n = power as f32;
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    let mut series = 1.0 / 5040.0;
    for coefficient in [
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        series = series * r + coefficient;
    }
    series * f32::from_bits(((power + 127) as u32) << 23)
}

/// `x * sigmoid(1.702 x)`: the GELU that the student is trained with.
#[must_use]
pub fn gelu(x: f32) -> f32 {
    x / (1.0 + exp(-1.702 * x))
}

/// One over the square root of `x`, relative error at most 2e-7; 0 for what is not above 0.
///
/// `x` normal. Three Newton steps from the bit-pattern guess (4 % off).
#[must_use]
pub fn inverse_square_root(x: f32) -> f32 {
    // The guess subtracts bit patterns and would wrap for negative numbers and negative NaNs.
    if x.is_nan() || x <= 0.0 {
        return 0.0;
    }
    let half = 0.5 * x;
    let mut y = F32Ext::invsqrt(x);
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    y
}

/// The nearest integer, halves away from zero; exact for |x| < 2^23, saturating beyond, 0 for NaN.
///
/// The addend is the largest number below one half: one half itself would round
/// 0.499_999_97 up.
#[must_use]
#[inline]
pub fn round(x: f32) -> i32 {
    (x + 0.499_999_97_f32.copysign(x)) as i32
}

/// The largest magnitude, 0 of nothing; NaN if any value is NaN.
///
/// Magnitudes of floats are ordered as their bit patterns are, and the integer maximum is the
/// cheaper one on both machines.
#[must_use]
#[inline]
pub fn absmax(values: &[f32]) -> f32 {
    let largest = values
        .iter()
        .map(|value| value.to_bits() & 0x7fff_ffff)
        .fold(
            0,
            |largest, bits| if bits > largest { bits } else { largest },
        );
    f32::from_bits(largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_keeps_its_stated_error_over_its_whole_range() {
        let mut worst = 0.0_f64;
        for step in 0..=1_750_000 {
            let x = -87.0 + step as f32 * 1e-4;
            let truth = libm::exp(f64::from(x));
            worst = worst.max((f64::from(exp(x)) / truth - 1.0).abs());
        }
        assert!(worst <= 1.5e-7, "relative error {worst:e}");
    }

    #[test]
    fn exp_has_its_edges() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-0.0), 1.0);
        assert_eq!(exp(88.001), f32::INFINITY);
        assert_eq!(exp(f32::INFINITY), f32::INFINITY);
        assert_eq!(exp(-87.001), 0.0);
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
        assert!(exp(88.0).is_finite() && exp(-87.0).is_normal());
        assert!(exp(f32::NAN).is_nan());
    }

    #[test]
    fn gelu_follows_its_formula() {
        for step in -2000..=2000 {
            let x = step as f32 * 0.01;
            let truth = f64::from(x) / (1.0 + libm::exp(-1.702 * f64::from(x)));
            assert!((f64::from(gelu(x)) - truth).abs() <= 4e-7 * truth.abs().max(1.0));
        }
        assert_eq!(gelu(-1e30), 0.0);
    }

    #[test]
    fn inverse_square_root_keeps_its_stated_error() {
        let mut worst = 0.0_f64;
        let mut x = 1e-12_f32;
        while x < 1e12 {
            let truth = 1.0 / libm::sqrt(f64::from(x));
            worst = worst.max((f64::from(inverse_square_root(x)) / truth - 1.0).abs());
            x *= 1.000_1;
        }
        assert!(worst <= 2e-7, "relative error {worst:e}");
        for x in [0.0, -1.0, f32::NAN, -f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(inverse_square_root(x), 0.0);
        }
    }

    #[test]
    fn rounding_takes_halves_away_from_zero() {
        for (x, rounded) in [
            (0.5, 1),
            (-0.5, -1),
            (0.499_999_97, 0),
            (-0.499_999_97, 0),
            (2.5, 3),
            (-32_766.5, -32_767),
            (1e20, i32::MAX),
            (f32::NAN, 0),
        ] {
            assert_eq!(round(x), rounded, "{x}");
        }
        for step in -400_000..400_000 {
            let x = step as f32 * 0.081_3;
            assert_eq!(round(x), libm::round(f64::from(x)) as i32, "{x}");
        }
    }

    #[test]
    fn absmax_sees_either_sign() {
        assert_eq!(absmax(&[]), 0.0);
        assert_eq!(absmax(&[-0.0]), 0.0);
        assert_eq!(absmax(&[1.0, -3.5, 2.0]), 3.5);
        assert!(absmax(&[1.0, -f32::NAN]).is_nan());
    }
}
