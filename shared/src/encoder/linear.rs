//! Linear maps of quantized tokens.

use crate::{
    kernels::{Active, Kernels, TOKEN_LIMIT},
    model_file::LinearWeights,
};

/// Rows that one call of the kernel takes: enough to share its set-up, few enough for the stack.
const ROWS: usize = 16;

/// Gives every output `y = sum as f32 * (scale * row scale) + bias` to `store`, in this order.
///
/// The input is `codes * scale`; the sum is exact in i32. `outputs` has one place per row.
#[inline]
pub fn linear(
    map: &LinearWeights<'_>,
    codes: &[i16],
    scale: f32,
    outputs: &mut [f32],
    store: impl Fn(&mut f32, f32),
) {
    let mut sums = [0; ROWS];
    let mut constants = map.scales.iter().zip(map.bias.iter());
    let blocks = map.weights.chunks(ROWS * codes.len().max(1));
    for (rows, outputs) in blocks.zip(outputs.chunks_mut(ROWS)) {
        let sums = &mut sums[..outputs.len()];
        Active::multiply(rows, codes, sums);
        for ((output, &sum), (row_scale, bias)) in
            outputs.iter_mut().zip(&*sums).zip(&mut constants)
        {
            store(output, sum as f32 * (scale * row_scale) + bias);
        }
    }
}

/// As [`linear`], for an input in f32: quantized as one token first.
#[inline]
pub fn linear_of_token<const N: usize>(
    map: &LinearWeights<'_>,
    token: &[[f32; N]],
    outputs: &mut [f32],
    store: impl Fn(&mut f32, f32),
) {
    // A token is one or two rows of N: the width, or the feed-forward's twice the width.
    let mut codes = [[0; N]; 2];
    let codes = &mut codes.as_flattened_mut()[..token.len() * N];
    let scale = Active::quantize(token.as_flattened(), TOKEN_LIMIT, codes);
    linear(map, codes, scale, outputs, store);
}

/// The output replaces what was there.
#[inline]
pub fn replace(place: &mut f32, value: f32) {
    *place = value;
}

/// The output is added to what was there: the residual stream.
#[inline]
pub fn add(place: &mut f32, value: f32) {
    *place += value;
}
