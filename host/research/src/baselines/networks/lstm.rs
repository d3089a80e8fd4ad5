//! LSTM: a recurrent network on moving standard deviations.

use burn::module::Module;
use burn::nn::lstm::{Lstm, LstmConfig};
use burn::nn::{Initializer, Linear, LinearConfig};
use burn::tensor::{Device, Tensor};
use shared::units::CHANNELS;
use training::optimization::initial;

use super::Network;

/// Width of the linear layer before the recurrent layer.
const PROJECTION: usize = 400;
/// Width of the recurrent layer's state.
const HIDDEN: usize = 256;

/// LSTM network.
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

#[cfg(test)]
mod tests {
    use super::*;
    use training::optimization::read_back;

    #[test]
    fn has_as_many_parameters_as_counted_by_hand() {
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
}
