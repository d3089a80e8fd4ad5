//! Training of teacher, student and baselines: the loop, the learning-rate schedule, weight averaging, the loss, dropout,
//! augmentation.

mod checkpoint;
pub mod dropout;
mod ema;
mod epoch;
pub mod fit;
#[cfg(feature = "flex")]
pub(crate) mod kernels;
pub mod learner;
pub mod loss;
pub(crate) mod metrics;
pub mod optimizer;
pub(crate) mod tune;

use burn::tensor::Tensor;

/// Reads the values of a tensor in row-major order.
///
/// # Panics
/// When a GPU could not compute the tensor, for instance for lack of memory. Never on CPU backends, whose floats convert to f32.
#[must_use]
pub fn read_back<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    tensor
        .try_into_vec_as::<f32>()
        .expect("a tensor of this device can be read back as f32")
}

/// Class of the largest logit, the lowest one on ties.
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
