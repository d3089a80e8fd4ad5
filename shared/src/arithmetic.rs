//! Arithmetic in a fixed order, the same bits on every target.

/// e to the power of `x`.
#[must_use]
pub fn exp(x: f32) -> f32 {
    use core::f32::consts::LOG2_E;
    if x < -87.0 {
        return 0.0;
    }
    let scaled = x.min(88.0) * LOG2_E;
    let power = if scaled < 0.0 {
        scaled - 0.5
    } else {
        scaled + 0.5
    } as i32;
    // ln 2 in two parts, so that the remainder keeps its low bits.
    let rest = x.min(88.0) - power as f32 * 0.693_359_4 + power as f32 * 2.121_944_4e-4;
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
        series = series * rest + coefficient;
    }
    series * f32::from_bits(((power + 127) as u32) << 23)
}
