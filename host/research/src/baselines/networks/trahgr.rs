//! TraHGR: a transformer with two paths over one window, low-pass filtered with three orders. A token of the temporal path
//! is a channel; a token of the featural path is a block of eight samples.

use burn::module::{Module, Param};
use burn::nn::{Initializer, LayerNorm, LayerNormConfig, Linear, LinearConfig};
use burn::tensor::activation::{gelu, softmax};
use burn::tensor::{Device, Tensor};
use shared::units::{CHANNELS, WINDOW};

use super::Network;
use crate::baselines::features::FILTER_ORDERS;
use training::optimization::dropout::Dropout;

/// Number of samples in a token of the featural path.
const BLOCK: usize = 8;

/// Dimensions of the network.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TraHgrConfig {
    /// Width of a token.
    d_model: usize,
    /// Number of attention heads; a divisor of `d_model`.
    heads: usize,
    /// Number of encoder layers of each path.
    layers: usize,
    /// Hidden width of the feed-forward blocks.
    feed_forward: usize,
    /// Dropout on attention weights, after attention and in the feed-forward blocks.
    dropout: f64,
}

impl Default for TraHgrConfig {
    fn default() -> Self {
        Self {
            d_model: 144,
            heads: 8,
            layers: 1,
            feed_forward: 576,
            dropout: 0.15,
        }
    }
}

impl TraHgrConfig {
    /// Creates a network with random weights.
    pub(crate) fn init(&self, classes: usize, device: &Device) -> TraHgr {
        let orders = FILTER_ORDERS.len();
        let path = |tokens, numbers| self.path(tokens, numbers, classes, device);
        TraHgr {
            temporal: path(CHANNELS, WINDOW * orders),
            featural: path(WINDOW / BLOCK, CHANNELS * BLOCK * orders),
            fused: Head::new(self.d_model, classes, device),
        }
    }

    fn path(&self, tokens: usize, numbers: usize, classes: usize, device: &Device) -> Path {
        let d = self.d_model;
        let small = Initializer::Normal {
            mean: 0.0,
            std: 0.02,
        };
        Path {
            embedding: linear(numbers, d, device),
            class_token: small.init([1, 1, d], device),
            positional_embedding: small.init([1, tokens + 1, d], device),
            layers: (0..self.layers)
                .map(|_| Layer {
                    norm1: LayerNormConfig::new(d).init(device),
                    qkv: linear(d, 3 * d, device),
                    out: linear(d, d, device),
                    norm2: LayerNormConfig::new(d).init(device),
                    linear1: linear(d, self.feed_forward, device),
                    linear2: linear(self.feed_forward, d, device),
                    heads: self.heads,
                    dropout: self.dropout,
                })
                .collect(),
            head: Head::new(d, classes, device),
        }
    }
}

/// Linear layer with Xavier (Glorot) uniform weights and biases of 0, the reference's initialization.
fn linear(from: usize, to: usize, device: &Device) -> Linear {
    let mut linear = LinearConfig::new(from, to)
        .with_initializer(Initializer::XavierUniform { gain: 1.0 })
        .init(device);
    linear.bias = Some(Initializer::Zeros.init([to], device));
    linear
}

/// TraHGR network.
#[derive(Module, Debug)]
pub(crate) struct TraHgr {
    temporal: Path,
    featural: Path,
    fused: Head,
}

/// Path of the network: a class token and the path's tokens, encoded together.
#[derive(Module, Debug)]
struct Path {
    embedding: Linear,
    class_token: Param<Tensor<3>>,
    positional_embedding: Param<Tensor<3>>,
    layers: Vec<Layer>,
    head: Head,
}

/// Pre-norm encoder layer.
#[derive(Module, Debug)]
struct Layer {
    norm1: LayerNorm,
    qkv: Linear,
    out: Linear,
    norm2: LayerNorm,
    linear1: Linear,
    linear2: Linear,
    heads: usize,
    dropout: f64,
}

/// Norm and logits of a class token.
#[derive(Module, Debug)]
struct Head {
    norm: LayerNorm,
    out: Linear,
}

impl Head {
    fn new(d: usize, classes: usize, device: &Device) -> Self {
        Self {
            norm: LayerNormConfig::new(d).init(device),
            out: linear(d, classes, device),
        }
    }

    fn forward(&self, class_token: Tensor<3>) -> Tensor<3> {
        self.out.forward(self.norm.forward(class_token))
    }
}

impl Network for TraHgr {
    fn forward(&self, input: Tensor<2>, dropout: &mut Dropout) -> Vec<Tensor<3>> {
        let temporal = self.temporal.forward(temporal(input.clone()), dropout);
        let featural = self.featural.forward(featural(input), dropout);
        vec![
            self.fused.forward(temporal.clone() + featural.clone()),
            self.temporal.head.forward(temporal),
            self.featural.head.forward(featural),
        ]
    }
}

/// Reshapes `[windows, channel × sample × order]` to one token per channel.
fn temporal(input: Tensor<2>) -> Tensor<3> {
    let [batch, numbers] = input.dims();
    input.reshape([batch, CHANNELS, numbers / CHANNELS])
}

/// Reshapes `[windows, channel × sample × order]` to one token per block of samples, ordered by channel inside.
fn featural(input: Tensor<2>) -> Tensor<3> {
    let [batch, numbers] = input.dims();
    let block = BLOCK * FILTER_ORDERS.len();
    let tokens = numbers / CHANNELS / block;
    input
        .reshape([batch, CHANNELS, tokens, block])
        .swap_dims(1, 2)
        .reshape([batch, tokens, CHANNELS * block])
}

impl Path {
    /// Encodes the tokens. Returns the class token, `[windows, 1, d]`.
    fn forward(&self, tokens: Tensor<3>, dropout: &mut Dropout) -> Tensor<3> {
        let [batch, _, _] = tokens.dims();
        let [_, _, d] = self.class_token.dims();
        let class_token = self.class_token.val().expand([batch, 1, d]);
        let tokens = Tensor::cat(vec![class_token, self.embedding.forward(tokens)], 1);
        let mut x = tokens + self.positional_embedding.val();
        for layer in &self.layers {
            x = layer.forward(x, dropout);
        }
        x.slice([0..batch, 0..1])
    }
}

impl Layer {
    fn forward(&self, x: Tensor<3>, dropout: &mut Dropout) -> Tensor<3> {
        let attended = self.attention(self.norm1.forward(x.clone()), dropout);
        let x = x + dropout.drop(attended, self.dropout);
        let hidden = gelu(self.linear1.forward(self.norm2.forward(x.clone())));
        let hidden = self.linear2.forward(dropout.drop(hidden, self.dropout));
        x + dropout.drop(hidden, self.dropout)
    }

    fn attention(&self, x: Tensor<3>, dropout: &mut Dropout) -> Tensor<3> {
        let [batch, tokens, d] = x.dims();
        let width = d / self.heads;
        let qkv = self
            .qkv
            .forward(x)
            .reshape([batch, tokens, 3, self.heads, width])
            .permute([2, 0, 3, 1, 4]);
        let part = |i: usize| qkv.clone().slice_dim(0, i..i + 1).squeeze_dim::<4>(0);
        let scores = part(0).matmul(part(1).swap_dims(2, 3)) * (1.0 / (width as f32).sqrt());
        let weights = dropout.drop(softmax(scores, 3), self.dropout);
        let attended = weights.matmul(part(2)).swap_dims(1, 2);
        self.out.forward(attended.reshape([batch, tokens, d]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::networks::lock_random_weights;
    use training::optimization::read_back;

    #[test]
    fn has_as_many_parameters_as_counted_by_hand() {
        let _lock = lock_random_weights();
        let model = TraHgrConfig::default().init(3, &Device::default());
        let layer = 144 * 432 + 432 + 144 * 144 + 144 + 144 * 576 + 576 + 576 * 144 + 144 + 4 * 144;
        let temporal = 1800 * 144 + 144 + (1 + 9) * 144 + layer;
        let featural = 192 * 144 + 144 + (1 + 76) * 144 + layer;
        let heads = 3 * (2 * 144 + 144 * 3 + 3);
        assert_eq!(model.num_params(), temporal + featural + heads);
    }

    #[test]
    fn a_token_holds_the_numbers_of_its_channel_or_block() {
        // Each number is its own index in [channel][sample][order].
        let input: Vec<f32> = (0..14_400_u16).map(f32::from).collect();
        let input =
            Tensor::<1>::from_floats(input.as_slice(), &Device::default()).reshape([1, 14_400]);
        let index = |channel: usize, sample: usize, order: usize| {
            ((channel * WINDOW + sample) * 3 + order) as f32
        };
        let found = read_back(temporal(input.clone()));
        assert_eq!(found[5 * 1800 + 17 * 3 + 2], index(5, 17, 2));
        let found = read_back(featural(input));
        // Token 2 holds samples 16..24; its fourth sample in channel 5, second order.
        assert_eq!(found[2 * 192 + 5 * 24 + 3 * 3 + 1], index(5, 19, 1));
    }
}
