//! MLP: four wide layers with batch norm on time-domain features.

use burn::module::Module;
use burn::nn::{BatchNorm, BatchNormConfig, Linear, LinearConfig};
use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor};

use super::Network;
use training::optimization::dropout::Dropout;

/// Dimensions of the network.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MlpConfig {
    /// Number of input features.
    features: usize,
    /// Width of each hidden layer.
    hidden: usize,
    /// Number of hidden layers.
    layers: usize,
    /// Dropout after each hidden layer.
    dropout: f64,
}

impl Default for MlpConfig {
    fn default() -> Self {
        Self {
            features: 48,
            hidden: 1000,
            layers: 4,
            dropout: 0.3,
        }
    }
}

impl MlpConfig {
    /// Creates a network with random weights.
    pub(crate) fn init(&self, classes: usize, device: &Device) -> Mlp {
        let input = |layer| {
            if layer == 0 {
                self.features
            } else {
                self.hidden
            }
        };
        Mlp {
            linear: (0..self.layers)
                .map(|layer| LinearConfig::new(input(layer), self.hidden).init(device))
                .collect(),
            norm: (0..self.layers)
                .map(|_| BatchNormConfig::new(self.hidden).init(device))
                .collect(),
            out: LinearConfig::new(self.hidden, classes).init(device),
            dropout: self.dropout,
        }
    }
}

/// MLP network.
#[derive(Module, Debug)]
pub(crate) struct Mlp {
    linear: Vec<Linear>,
    norm: Vec<BatchNorm>,
    out: Linear,
    dropout: f64,
}

impl Network for Mlp {
    const BATCH_NORM: bool = true;

    fn forward(&self, input: Tensor<2>, dropout: &mut Dropout) -> Vec<Tensor<3>> {
        let mut x = input;
        for (linear, norm) in self.linear.iter().zip(&self.norm) {
            x = dropout.drop(relu(norm.forward(linear.forward(x))), self.dropout);
        }
        vec![self.out.forward(x).unsqueeze_dim(1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::networks::lock_random_weights;

    #[test]
    fn has_as_many_parameters_as_counted_by_hand() {
        let _lock = lock_random_weights();
        let model = MlpConfig::default().init(3, &Device::default());
        let layers = (48 + 1) * 1000 + 3 * (1000 + 1) * 1000;
        let norms = 4 * 2 * 1000;
        // Burn also counts the running means and variances, which are not trained.
        let running = 4 * 2 * 1000;
        assert_eq!(
            model.num_params(),
            layers + norms + running + (1000 + 1) * 3
        );
    }
}
