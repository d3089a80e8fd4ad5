//! Kernels of the CPU backend's fused operations: vectorized loops over values in the cache.

pub(crate) mod exponential;
pub(crate) mod matmul;
pub(crate) mod softmax;

use burn::tensor::{DType, Device, Tensor};

/// Whether the CPU backend's fused operations accept this tensor.
pub(crate) fn is_flex<const D: usize>(x: &Tensor<D>) -> bool {
    x.dtype() == DType::F32 && x.device() == Device::flex()
}

/// Number of independent partial sums of a row: without them each addition would wait for the one before.
const LANES: usize = 16;

/// Dot product of two rows.
#[inline(always)]
pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f32 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f32>() + rest
}

/// Folds the values of a row, in a fixed order that is not the order of the row.
#[inline(always)]
pub(crate) fn fold(row: &[f32], start: f32, join: impl Fn(f32, f32) -> f32) -> f32 {
    let mut lanes = [start; LANES];
    let chunks = row.chunks_exact(LANES);
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, &x) in lanes.iter_mut().zip(chunk) {
            *lane = join(*lane, x);
        }
    }
    rest.iter().chain(&lanes).fold(start, |a, &b| join(a, b))
}
