//! Kernels of the CPU backend's fused operations: vectorized loops over values in the cache.

pub(crate) mod exponential;
pub(crate) mod matmul;
pub(crate) mod reduction;
pub(crate) mod softmax;

use burn::tensor::{DType, Device, Tensor};

/// Whether the CPU backend's fused operations accept this tensor.
pub(crate) fn is_flex<const D: usize>(x: &Tensor<D>) -> bool {
    x.dtype() == DType::F32 && x.device() == Device::flex()
}
