//! The exponential function, written so that the compiler vectorizes a loop over it.
//!
//! Multiplications and additions are not fused: a fused multiply-add rounds differently, and the result
//! would depend on the processor.

/// `exp(x)` for `x` up to 0 (and a rounding error above it), with a relative error below 3e-7. Below -87 it is
/// `exp(-87)`.
///
/// `x = n ln 2 + r`: a power of two from its exponent bits, times the Taylor series of `exp(r)`, whose
/// next term is below `(ln 2 / 2)^7 / 7! = 1.2e-7`.
#[inline(always)]
pub(crate) fn exp_negative(x: f32) -> f32 {
    /// Constant 1.5 * 2^23: the lowest bits of a small number plus this are the nearest integer.
    const ROUND: f32 = 12_582_912.0;
    /// Constant ln 2 in two parts, the first with few significant bits, so that its multiples are exact.
    const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
    let x = if x > -87.0 { x } else { -87.0 };
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * LN_2[0] - n * LN_2[1];
    let series = 1.0 / 120.0 + r * (1.0 / 720.0);
    let series = 1.0 / 6.0 + r * (1.0 / 24.0 + r * series);
    let series = 1.0 + r * (1.0 + r * (0.5 + r * series));
    let power = f32::from_bits((shifted.to_bits() << 23).wrapping_add(0x3f80_0000));
    series * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_is_as_exact_as_documented() {
        for step in 0..=870_000 {
            let x = step as f32 * -1e-4;
            let expected = f64::from(x).exp();
            let off = (f64::from(exp_negative(x)) / expected - 1.0).abs();
            assert!(off < 3e-7, "exp({x}) off by {off:e}");
        }
        assert!(exp_negative(f32::NEG_INFINITY) < 2e-38);
    }
}
