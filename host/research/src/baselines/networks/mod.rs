//! Neural networks of the baselines.

mod ed_tcn;
mod lstm;

use burn::module::Module;
use burn::tensor::Tensor;

pub(crate) use ed_tcn::EdTcn;
pub(crate) use lstm::LstmBaseline;

/// Network that classifies the frames of windows.
pub(crate) trait Network: Module + Sync {
    /// Computes logits, `[windows, frames, classes]`, from a batch of inputs `[windows, numbers]` of the feature extraction.
    fn forward(&self, input: Tensor<2>) -> Tensor<3>;
}
