//! The baselines' neural networks.

mod ed_tcn;
mod lstm;
mod mlp;
mod trahgr;

use burn::module::Module;
use burn::tensor::Tensor;

use training::optimization::dropout::Dropout;

pub(crate) use ed_tcn::EdTcnConfig;
pub(crate) use lstm::LstmBaselineConfig;
pub(crate) use mlp::MlpConfig;
pub(crate) use trahgr::TraHgrConfig;

/// A network that classifies the frames of windows.
pub(crate) trait Network: Module + Sync {
    /// Whether it has batch norm, which needs the statistics of a whole, undivided batch.
    const BATCH_NORM: bool = false;

    /// From a batch of inputs `[windows, numbers]`, as the feature extraction makes them, to the logits
    /// of each head, `[windows, frames, classes]`.
    ///
    /// The first head is the prediction. In training the losses of all heads are added.
    fn forward(&self, input: Tensor<2>, dropout: &mut Dropout) -> Vec<Tensor<3>>;
}

/// Held by tests that draw random weights: a backend has one random generator for the whole process, so
/// parallel tests would get each other's numbers in spite of their seeds.
#[cfg(test)]
pub(crate) fn lock_random_weights() -> std::sync::MutexGuard<'static, ()> {
    static LOCK: std::sync::Mutex<()> = std::sync::Mutex::new(());
    LOCK.lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}
