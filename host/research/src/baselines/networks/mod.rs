//! Neural networks of the baselines.

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

/// Network that classifies the frames of windows.
pub(crate) trait Network: Module + Sync {
    /// Whether the network has batch norm, which needs the statistics of a whole, undivided batch.
    const BATCH_NORM: bool = false;

    /// Computes the logits of each head, `[windows, frames, classes]`, from a batch of inputs `[windows, numbers]` of the
    /// feature extraction.
    ///
    /// The first head is the prediction. In training the losses of all heads are added.
    fn forward(&self, input: Tensor<2>, dropout: &mut Dropout) -> Vec<Tensor<3>>;
}

/// Locks the random weights for a test: a backend has one random generator a process, so parallel tests would get each
/// other's numbers in spite of their seeds.
#[cfg(test)]
pub(crate) fn lock_random_weights() -> std::sync::MutexGuard<'static, ()> {
    static LOCK: std::sync::Mutex<()> = std::sync::Mutex::new(());
    LOCK.lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}
