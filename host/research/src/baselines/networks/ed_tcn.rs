//! ED-TCN: an encoder-decoder of temporal convolutions with two poolings and two upsamplings.

use burn::module::Module;
use burn::nn::PaddingConfig1d;
use burn::nn::conv::{Conv1d, Conv1dConfig};
use burn::nn::pool::{MaxPool1d, MaxPool1dConfig};
use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor};
use shared::units::CHANNELS;

use super::Network;
use myointent::training::dropout::Dropout;

/// Dimensions of the network.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdTcnConfig {
    /// Filters of the outer and of the inner convolutions.
    filters: [usize; 2],
    /// Kernel size in frames; odd.
    kernel: usize,
}

impl Default for EdTcnConfig {
    fn default() -> Self {
        Self {
            filters: [128, 288],
            kernel: 9,
        }
    }
}

impl EdTcnConfig {
    /// A network with random weights.
    pub(crate) fn init(&self, classes: usize, device: &Device) -> EdTcn {
        let [outer, inner] = self.filters;
        let half = self.kernel / 2;
        let convolution = |from, to| {
            Conv1dConfig::new(from, to, self.kernel)
                .with_padding(PaddingConfig1d::Explicit(half, half))
                .init(device)
        };
        EdTcn {
            encoder: vec![convolution(CHANNELS, outer), convolution(outer, inner)],
            decoder: vec![convolution(inner, inner), convolution(inner, outer)],
            out: Conv1dConfig::new(outer, classes, 1).init(device),
            pool: MaxPool1dConfig::new(2).with_stride(2).init(),
        }
    }
}

/// The network.
#[derive(Module, Debug)]
pub(crate) struct EdTcn {
    encoder: Vec<Conv1d>,
    decoder: Vec<Conv1d>,
    out: Conv1d,
    pool: MaxPool1d,
}

impl Network for EdTcn {
    fn forward(&self, input: Tensor<2>, _: &mut Dropout) -> Vec<Tensor<3>> {
        let [batch, numbers] = input.dims();
        let mut x = input
            .reshape([batch, numbers / CHANNELS, CHANNELS])
            .swap_dims(1, 2);
        for convolution in &self.encoder {
            x = self.pool.forward(relu(convolution.forward(x)));
        }
        for convolution in &self.decoder {
            x = relu(convolution.forward(upsampled(x)));
        }
        vec![self.out.forward(x).swap_dims(1, 2)]
    }
}

/// Repeats every frame, `[windows, filters, frames]` to `[windows, filters, 2 frames]`.
fn upsampled(x: Tensor<3>) -> Tensor<3> {
    let [batch, filters, frames] = x.dims();
    x.unsqueeze_dim::<4>(3)
        .repeat_dim(3, 2)
        .reshape([batch, filters, 2 * frames])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::networks::lock_random_weights;
    use myointent::training::tensor::read_back;

    #[test]
    fn has_as_many_parameters_as_counted_by_hand() {
        let _lock = lock_random_weights();
        let model = EdTcnConfig::default().init(3, &Device::default());
        let encoder = (8 * 9 + 1) * 128 + (128 * 9 + 1) * 288;
        let decoder = (288 * 9 + 1) * 288 + (288 * 9 + 1) * 128;
        assert_eq!(model.num_params(), encoder + decoder + (128 + 1) * 3);
    }

    #[test]
    fn logits_are_in_the_order_of_the_frames() {
        let _lock = lock_random_weights();
        let device = Device::default();
        let x = Tensor::<3>::from_floats([[[1.0, 2.0], [3.0, 4.0]]], &device);
        let found = read_back(upsampled(x));
        assert_eq!(found, [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0]);
        let model = EdTcnConfig::default().init(3, &device);
        let logits = model.forward(Tensor::ones([2, 160], &device), &mut Dropout::off());
        assert_eq!(logits[0].dims(), [2, 20, 3]);
    }
}
