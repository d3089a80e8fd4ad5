//! Float functions of the encoder, each with a fixed order of operations.
//!
//! They consist of single IEEE operations and bit operations, without a platform libm and without fused
//! multiply-add: every bit agrees on x86-64 and on a Cortex-M4F. The order is part of each function's
//! definition; do not rearrange it.

use micromath::F32Ext;

/// Above this [`exp`] is infinite; below its negative, where e^x is under 1.7e-38, it is zero.
const EXP_LIMIT: f32 = 87.0;
/// Entries of [`exp`]'s table per power of two.
const STEPS: usize = 128;
/// `2^(step / 128)`, by 128 products in f64.
const POWERS: [f32; STEPS] = {
    const ROOT: f64 = 1.005_429_901_112_802_8;
    let mut powers = [1.0; STEPS];
    let mut power = 1.0;
    let mut step = 0;
    while step < STEPS {
        powers[step] = power as f32;
        power *= ROOT;
        step += 1;
    }
    powers
};
/// 1.5 x 2^23: the sum with a number below 2^22 has the nearest integer, halves to even, in its lowest
/// bits, as two's complement.
pub(crate) const ROUNDING: f32 = 12_582_912.0;

/// e to the power `x`; relative error at most 5e-6 for |x| <= 8, 1e-5 everywhere.
///
/// Infinite above 87, zero below -87, NaN for NaN. `x` is a number of steps of ln 2 / 128 and a fraction of at most half
/// of one, whose power is its Taylor series to the first power (the next term is 3.7e-6); that of the steps is from a
/// table, shifted.
#[must_use]
#[inline(always)]
pub(crate) fn exp(x: f32) -> f32 {
    if x.to_bits() & 0x7fff_ffff > EXP_LIMIT.to_bits() {
        return exp_beyond(x);
    }
    let steps = x * (STEPS as f32 * core::f32::consts::LOG2_E);
    let shifted = steps + ROUNDING;
    let bits = shifted.to_bits();
    let fraction = steps - (shifted - ROUNDING);
    let series = fraction * (core::f32::consts::LN_2 / STEPS as f32) + 1.0;
    let power = POWERS[bits as usize % STEPS].to_bits();
    // The integer's bits above those of the table index, as an exponent.
    let exponent = (bits >> STEPS.ilog2()) << 23;
    series * f32::from_bits(power.wrapping_add(exponent))
}

#[cold]
fn exp_beyond(x: f32) -> f32 {
    if x.is_nan() {
        x
    } else if x > 0.0 {
        f32::INFINITY
    } else {
        0.0
    }
}

/// Argument from which [`gelu`]'s distance to a ramp counts as 0: it is below 1e-5.
const GELU_END: f32 = 8.0;
/// Lines of [`gelu`]'s table, from 0 to [`GELU_END`].
const LINES: usize = 256;
/// `a * sigmoid(-1.702 a)` at the beginning of each line, and what it grows by until the next.
const RAMP_LESS_GELU: [[f32; 2]; LINES] = {
    // e^(-1.702 / 32), by whose powers the exponential is computed.
    const RATIO: f64 = 0.948_202_207_899_688_3;
    let mut lines = [[0.0; 2]; LINES];
    let (mut line, mut power, mut before) = (0, 1.0, 0.0);
    while line < LINES {
        power *= RATIO;
        let a = (line + 1) as f64 * (GELU_END as f64 / LINES as f64);
        let next = a * power / (1.0 + power);
        lines[line] = [before as f32, (next - before) as f32];
        before = next;
        line += 1;
    }
    lines
};

/// `x * sigmoid(1.702 x)`: the GELU approximation that the student is trained with; error at most 1.1e-4.
///
/// A ramp less an even function, which is interpolated in a table: a third of the cycles of an exponential and a
/// division on a Cortex-M4, and far finer than the codes that the result is rounded to.
#[must_use]
#[inline(always)]
pub(crate) fn gelu(x: f32) -> f32 {
    let bits = x.to_bits();
    if bits & 0x7fff_ffff >= GELU_END.to_bits() {
        return gelu_beyond(x);
    }
    let place = x.abs() * (LINES as f32 / GELU_END);
    let line = place as u32;
    let [start, slope] = RAMP_LESS_GELU[line as usize % LINES];
    // max(x, 0): no bits if the sign is set.
    let ramp = f32::from_bits(bits & !(bits.cast_signed() >> 31).cast_unsigned());
    ramp - (start + (place - line as f32) * slope)
}

#[cold]
fn gelu_beyond(x: f32) -> f32 {
    if x < 0.0 { 0.0 } else { x }
}

/// Reciprocal square root of `x`, relative error at most 2e-7; 0 if `x` is not above 0.
///
/// `x` normal. Three Newton steps from the bit-pattern guess (4 % off).
#[must_use]
pub(crate) fn inverse_square_root(x: f32) -> f32 {
    // The first guess subtracts bit patterns, which would wrap for negative numbers and NaNs.
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
/// The addend is the largest number below one half: one half itself would round 0.499_999_97 up.
#[must_use]
#[inline]
pub(crate) fn round(x: f32) -> i32 {
    (x + 0.499_999_97_f32.copysign(x)) as i32
}

/// The nearest integer, halves to even; |x| < 2^22.
#[must_use]
#[inline]
pub(crate) fn round_to_even(x: f32) -> i32 {
    (x + ROUNDING).to_bits() as i32 - ROUNDING.to_bits() as i32
}

/// The largest magnitude; 0 without values, NaN if any value is NaN.
///
/// Magnitudes of floats are ordered as their bit patterns, and the integer maximum is faster on x86-64
/// and on a Cortex-M4F.
#[must_use]
#[inline]
pub(crate) fn absmax(values: &[f32]) -> f32 {
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
    use crate::model::noise::Noise;

    fn worst_error_of_exp(limit: f32) -> f64 {
        let mut worst = 0.0_f64;
        for step in (-870_000..=870_000).step_by(5) {
            let x = step as f32 * 1e-6 * limit / 0.87;
            let truth = libm::exp(f64::from(x));
            worst = worst.max((f64::from(exp(x)) / truth - 1.0).abs());
        }
        worst
    }

    #[test]
    fn exp_has_its_stated_errors() {
        let [near, everywhere] = [8.0, EXP_LIMIT].map(worst_error_of_exp);
        assert!(near <= 5e-6, "relative error {near:e}");
        assert!(everywhere <= 1e-5, "relative error {everywhere:e}");
    }

    #[test]
    fn exp_has_its_limits() {
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-0.0), 1.0);
        assert_eq!(exp(87.001), f32::INFINITY);
        assert_eq!(exp(f32::INFINITY), f32::INFINITY);
        assert_eq!(exp(-87.001), 0.0);
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
        assert!(exp(87.0).is_finite() && exp(-87.0).is_normal());
        assert!(exp(f32::NAN).is_nan() && exp(-f32::NAN).is_nan());
    }

    #[test]
    fn the_table_of_exp_holds_the_roots_of_two() {
        for (step, power) in POWERS.into_iter().enumerate() {
            let truth = libm::exp2(step as f64 / STEPS as f64);
            assert_eq!(power, truth as f32, "{step}");
        }
    }

    #[test]
    fn gelu_follows_its_formula() {
        for step in -2000..=2000 {
            let x = step as f32 * 0.01;
            let truth = f64::from(x) / (1.0 + libm::exp(-1.702 * f64::from(x)));
            assert!((f64::from(gelu(x)) - truth).abs() <= 1.1e-4, "{x}");
        }
        assert_eq!(
            [-1e30, f32::NEG_INFINITY, -0.0, 1e30].map(gelu),
            [0.0, 0.0, 0.0, 1e30]
        );
        assert!(gelu(f32::NAN).is_nan() && gelu(-f32::NAN).is_nan());
    }

    #[test]
    fn inverse_square_root_has_its_stated_error() {
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
    fn rounding_to_even_is_that_of_floats() {
        for step in -400_000..400_000 {
            let x = step as f32 * 0.25;
            assert_eq!(round_to_even(x), libm::rint(f64::from(x)) as i32, "{x}");
        }
        assert_eq!([0.5, 1.5, -0.5, -2.5].map(round_to_even), [0, 2, 0, -2]);
        assert_eq!(round_to_even(-32_767.0), -32_767);
    }

    /// The checksum is the same on the PC and on the emulated core.
    #[test]
    fn every_machine_gives_the_same_bits() {
        let mut noise = Noise(7);
        let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
        let mut digest = checksum.digest();
        for _ in 0..20_000 {
            let x = noise.signed() * [0.01, 1.0, 10.0, 100.0][noise.bits() as usize % 4];
            let results = [
                exp(x),
                gelu(x),
                inverse_square_root(x),
                round_to_even(x) as f32,
            ];
            for result in results {
                digest.update(&result.to_bits().to_le_bytes());
            }
        }
        assert_eq!(digest.finalize(), 1_749_541_507);
    }

    #[test]
    fn absmax_takes_either_sign() {
        assert_eq!(absmax(&[]), 0.0);
        assert_eq!(absmax(&[-0.0]), 0.0);
        assert_eq!(absmax(&[1.0, -3.5, 2.0]), 3.5);
        assert!(absmax(&[1.0, -f32::NAN]).is_nan());
    }
}
