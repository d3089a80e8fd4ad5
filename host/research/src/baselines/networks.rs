//! Neural networks of the baselines: LSTM, a recurrent network on moving standard deviations, and ED-TCN, an encoder-decoder of
//! temporal convolutions with two poolings and two upsamplings.

use burn::module::Module;
use burn::nn::conv::{Conv1d, Conv1dConfig};
use burn::nn::lstm::{Lstm, LstmConfig};
use burn::nn::{Initializer, Linear, LinearConfig, PaddingConfig1d};
use burn::tensor::activation::relu;
use burn::tensor::{Device, Tensor};
use shared::units::CHANNELS;
use training::optimization::initial;

/// Network that classifies the frames of windows.
pub(crate) trait Network: Module + Sync {
    /// Computes logits, `[windows, frames, classes]`, from a batch of inputs `[windows, numbers]` of the feature extraction.
    fn forward(&self, input: Tensor<2>) -> Tensor<3>;
}

/// Width of the linear layer before the recurrent layer.
const PROJECTION: usize = 400;
/// Width of the recurrent layer's state.
const HIDDEN: usize = 256;

#[derive(Module, Debug)]
pub(crate) struct LstmBaseline {
    projection: Linear,
    lstm: Lstm,
    out: Linear,
}

impl LstmBaseline {
    /// Creates a network with the random weights of a seed.
    pub(crate) fn new(seed: u64, classes: usize, device: &Device) -> Self {
        // PyTorch's initialization, not Burn's.
        let bound = 1.0 / (HIDDEN as f64).sqrt();
        initial(seed, device, || Self {
            projection: LinearConfig::new(CHANNELS, PROJECTION).init(device),
            lstm: LstmConfig::new(PROJECTION, HIDDEN, true)
                .with_initializer(Initializer::Uniform {
                    min: -bound,
                    max: bound,
                })
                .init(device),
            out: LinearConfig::new(HIDDEN, classes).init(device),
        })
    }
}

impl Network for LstmBaseline {
    fn forward(&self, input: Tensor<2>) -> Tensor<3> {
        let [batch, numbers] = input.dims();
        let input = input.reshape([batch, numbers / CHANNELS, CHANNELS]);
        let x = self.projection.forward(input).tanh();
        // One time step per call: over a whole sequence, the layer writes every state into one tensor, and the backward
        // pass copies that tensor once per time step.
        let mut state = None;
        let mut hidden = Vec::with_capacity(numbers / CHANNELS);
        for step in x.iter_dim(1) {
            let (output, next) = self.lstm.forward(step, state);
            hidden.push(output);
            state = Some(next);
        }
        self.out.forward(Tensor::cat(hidden, 1))
    }
}

/// Number of filters of the outer and of the inner convolutions.
const FILTERS: [usize; 2] = [128, 288];
/// Kernel size in frames; odd.
const KERNEL: usize = 9;

#[derive(Module, Debug)]
pub(crate) struct EdTcn {
    encoder: Vec<Conv1d>,
    decoder: Vec<Conv1d>,
    out: Conv1d,
}

impl EdTcn {
    /// Creates a network with the random weights of a seed.
    pub(crate) fn new(seed: u64, classes: usize, device: &Device) -> Self {
        let [outer, inner] = FILTERS;
        let half = KERNEL / 2;
        let convolution = |from, to| {
            Conv1dConfig::new(from, to, KERNEL)
                .with_padding(PaddingConfig1d::Explicit(half, half))
                .init(device)
        };
        initial(seed, device, || Self {
            encoder: vec![convolution(CHANNELS, outer), convolution(outer, inner)],
            decoder: vec![convolution(inner, inner), convolution(inner, outer)],
            out: Conv1dConfig::new(outer, classes, 1).init(device),
        })
    }
}

impl Network for EdTcn {
    fn forward(&self, input: Tensor<2>) -> Tensor<3> {
        let [batch, numbers] = input.dims();
        let mut x = input.reshape([batch, numbers / CHANNELS, CHANNELS]);
        for convolution in &self.encoder {
            x = relu(pooled(convolved(convolution, x)));
        }
        for convolution in &self.decoder {
            x = relu(convolved(convolution, upsampled(x)));
        }
        convolved(&self.out, x)
    }
}

/// Convolves the frames of `[windows, frames, filters]`; their number stays the same.
///
/// It is one matrix product over all windows. Burn's convolution computes a product for each window, whose frames are too
/// few for it to be fast.
fn convolved(convolution: &Conv1d, x: Tensor<3>) -> Tensor<3> {
    let [batch, frames, filters] = x.dims();
    let weight = convolution.weight.val();
    let [to, _, kernel] = weight.dims();
    let zeros = Tensor::zeros([batch, kernel / 2, filters], &x.device());
    let padded = Tensor::cat(vec![zeros.clone(), x, zeros], 1);
    let shifted = (0..kernel).map(|at| padded.clone().slice_dim(1, at..at + frames));
    let neighbourhoods =
        Tensor::cat(shifted.collect(), 2).reshape([batch * frames, kernel * filters]);
    let weight = weight.swap_dims(1, 2).reshape([to, kernel * filters]);
    let y = neighbourhoods
        .matmul(weight.transpose())
        .reshape([batch, frames, to]);
    match &convolution.bias {
        Some(bias) => y + bias.val().reshape([1, 1, to]),
        None => y,
    }
}

/// Takes the larger value of every two frames; an odd last frame is dropped.
fn pooled(x: Tensor<3>) -> Tensor<3> {
    let [batch, frames, filters] = x.dims();
    let pairs = x.slice_dim(1, 0..frames / 2 * 2);
    pairs
        .reshape([batch, frames / 2, 2, filters])
        .max_dim(2)
        .squeeze_dim(2)
}

/// Repeats every frame, `[windows, frames, filters]` to `[windows, 2 frames, filters]`.
fn upsampled(x: Tensor<3>) -> Tensor<3> {
    let [batch, frames, filters] = x.dims();
    x.unsqueeze_dim::<4>(2)
        .repeat_dim(2, 2)
        .reshape([batch, 2 * frames, filters])
}

#[cfg(test)]
mod tests {
    use burn::nn::pool::MaxPool1dConfig;

    use super::*;
    use training::optimization::read_back;

    #[test]
    fn the_lstm_has_as_many_parameters_as_counted_by_hand() {
        let model = LstmBaseline::new(1, 3, &Device::default());
        // Four gates, each with one bias for the input and one for the state, as in PyTorch.
        let gates = 4 * (400 * 256 + 256 + 256 * 256 + 256);
        assert_eq!(model.num_params(), (8 + 1) * 400 + gates + (256 + 1) * 3);
    }

    #[test]
    fn single_time_steps_equal_the_whole_sequence() {
        let device = Device::default();
        let model = LstmBaseline::new(1, 3, &device);
        let input: Vec<f32> = (0..2 * 5 * 8_u8)
            .map(|x| (f32::from(x) * 0.7).sin())
            .collect();
        let input = Tensor::<1>::from_floats(input.as_slice(), &device).reshape([2, 40]);
        let found = model.forward(input.clone());
        let x = model.projection.forward(input.reshape([2, 5, 8])).tanh();
        let expected = model.out.forward(model.lstm.forward(x, None).0);
        for (found, expected) in read_back(found).iter().zip(read_back(expected)) {
            assert!(
                (found - expected).abs() < 1e-6,
                "{found} against {expected}"
            );
        }
    }

    #[test]
    fn the_ed_tcn_has_as_many_parameters_as_counted_by_hand() {
        let model = EdTcn::new(1, 3, &Device::default());
        let encoder = (8 * 9 + 1) * 128 + (128 * 9 + 1) * 288;
        let decoder = (288 * 9 + 1) * 288 + (288 * 9 + 1) * 128;
        assert_eq!(model.num_params(), encoder + decoder + (128 + 1) * 3);
    }

    #[test]
    fn logits_are_in_the_order_of_the_frames() {
        let device = Device::default();
        let x = Tensor::<3>::from_floats([[[1.0, 2.0], [3.0, 4.0]]], &device);
        let found = read_back(upsampled(x));
        assert_eq!(found, [1.0, 2.0, 1.0, 2.0, 3.0, 4.0, 3.0, 4.0]);
        let model = EdTcn::new(1, 3, &device);
        let logits = model.forward(Tensor::ones([2, 160], &device));
        assert_eq!(logits.dims(), [2, 20, 3]);
    }

    #[test]
    fn convolutions_and_poolings_are_those_of_burn() {
        let device = Device::default().autodiff();
        let convolution = initial(5, &device, || {
            Conv1dConfig::new(8, 12, 9)
                .with_padding(PaddingConfig1d::Explicit(4, 4))
                .init(&device)
        });
        let x: Vec<f32> = (0..3 * 11 * 8_u16)
            .map(|x| (f32::from(x) * 0.7).sin())
            .collect();
        let x = Tensor::<1>::from_floats(x.as_slice(), &device).reshape([3, 11, 8]);
        let x = x.detach().require_grad();
        let ours = pooled(convolved(&convolution, x.clone()));
        let pool = MaxPool1dConfig::new(2).with_stride(2).init();
        let burns = pool
            .forward(convolution.forward(x.clone().swap_dims(1, 2)))
            .swap_dims(1, 2);
        let close = |one: Tensor<3>, other: Tensor<3>| {
            assert_eq!(one.dims(), other.dims());
            for (one, other) in read_back(one).iter().zip(read_back(other)) {
                assert!((one - other).abs() < 1e-5, "{one} against {other}");
            }
        };
        close(ours.clone(), burns.clone());
        // Squares give every output its own gradient.
        let gradients = |y: Tensor<3>| {
            let gradients = y.powi_scalar(2).sum().backward();
            let weight = convolution.weight.val().grad(&gradients).unwrap();
            (weight, x.grad(&gradients).unwrap())
        };
        let (ours, burns) = (gradients(ours), gradients(burns));
        close(ours.0, burns.0);
        close(ours.1, burns.1);
    }
}
