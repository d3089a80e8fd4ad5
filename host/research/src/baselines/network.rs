//! What all baselines' networks have in common.

use burn::module::Module;
use burn::tensor::Tensor;

use myointent::training::dropout::Dropout;

/// A network over windows.
pub trait Network: Module + Sync {
    /// Whether a training batch must be computed in one piece: batch norm measures it.
    const IN_ONE_PIECE: bool = false;

    /// Runs a batch of inputs `[b, numbers]` as the front end makes them.
    ///
    /// Gives the logits of every head, `[b, steps, classes]` each: the losses of all are summed, and the
    /// first one is what the network says.
    fn forward(&self, input: Tensor<2>, dropout: &mut Dropout) -> Vec<Tensor<3>>;
}
