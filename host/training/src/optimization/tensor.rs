//! Values of tensors on the host.

use burn::tensor::Tensor;

/// Values of a tensor in row-major order.
///
/// # Panics
/// When a GPU could not compute it, for want of memory for instance. Never on the CPU backends, whose floats convert to f32.
#[must_use]
pub fn read_back<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor
        .try_into_vec_as::<f32>()
        .expect("a tensor of this device can be read back as f32")
}

/// The class of the largest logit, the lowest one on ties.
#[must_use]
pub fn best_class(logits: &[f32]) -> usize {
    (1..logits.len()).fold(0, |best, class| {
        if logits[class] > logits[best] {
            class
        } else {
            best
        }
    })
}
