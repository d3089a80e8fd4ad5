//! The integer inner loops of the encoder, and what chooses between their forms.
//!
//! [`portable`] is the meaning; a form for a processor is the same, faster; [`checks`] judges any
//! of them. Callers keep the bounds stated here: the accumulators are 32 bits wide and nothing
//! looks for an overflow at run time.

pub mod checks;
pub mod portable;

/// The form that the encoder uses on this target.
pub type Active = portable::Portable;

/// Longest row of weights: the second matrix of a feed-forward of 2 x 256.
pub const MAX_COLUMNS: usize = 512;
/// Largest code of a quantized token.
pub const TOKEN_LIMIT: i16 = i16::MAX;
/// Largest code of a query, and of a folded attention weight.
pub const QUERY_LIMIT: i16 = 4095;
/// Largest code of a key, and of a value.
pub const KEY_LIMIT: i16 = 8191;
/// Most terms of a product of two codes: a head's width, or the span.
pub const MAX_TERMS: usize = 32;

// i16 x i8 over 512 columns: 512 x 32768 x 127 = 2 130 706 432. With -128 it would be 2^31.
const _: () = assert!(MAX_COLUMNS as i64 * 32_768 * 127 <= i32::MAX as i64);
// Query x key over a head, attention weight x value over the span: below 2^12 x 2^13 x 2^5 = 2^30.
const _: () = assert!(QUERY_LIMIT as i64 * KEY_LIMIT as i64 * MAX_TERMS as i64 <= i32::MAX as i64);

/// The inner loops. Pure functions: a form has no state.
pub trait Kernels {
    /// `outputs[r] = sum over c of weights[r][c] * input[c]`, exactly.
    ///
    /// `weights` is row-major with rows as long as `input` (at most [`MAX_COLUMNS`]) and one row
    /// per output, all in -127..=127.
    fn multiply(weights: &[i8], input: &[i16], outputs: &mut [i32]);

    /// `sum of a[i] * b[i]`, exactly, over the shorter of the two.
    ///
    /// At most [`MAX_TERMS`] terms, |a| <= [`QUERY_LIMIT`] and |b| <= [`KEY_LIMIT`].
    fn dot(a: &[i16], b: &[i16]) -> i32;

    /// Codes in `-limit..=limit` and their scale, so that `value` is about `code * scale`.
    ///
    /// The scale is `absmax / limit`, each code `value * (limit / absmax)` rounded half away from
    /// zero. If the largest magnitude is below 1e-30 or not finite, all codes and the scale are 0.
    fn quantize(values: &[f32], limit: i16, codes: &mut [i16]) -> f32;
}
