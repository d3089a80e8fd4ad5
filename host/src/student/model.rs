//! Float twin of the device's streaming encoder (`shared::model::encoder`), for training.
//!
//! The same formulas over whole sequences: local causal attention is a band of the matrix of scores,
//! where the device keeps a ring of keys and values.

use burn::module::{Module, Param};
use burn::nn::{Initializer, LayerNorm, LayerNormConfig, Linear, LinearConfig};
use burn::tensor::activation::{sigmoid, softmax};
use burn::tensor::{Device, Int, Tensor, TensorData};
use serde::{Deserialize, Serialize};
use shared::model::dimensions::Companding;
use shared::units::{CHANNELS, LOOK_BACK, PATCH};

/// Dimensions of a student.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudentConfig {
    /// Width of a token; a patch is a token.
    pub d_model: usize,
    /// Attention heads; divides `d_model`.
    pub heads: usize,
    /// Encoder layers.
    pub layers: usize,
    /// Patches that a patch attends to, itself included.
    pub span: usize,
    /// Companding of the input.
    pub companding: Companding,
    /// Whether a board has to have room for it; otherwise only a PC runs it.
    #[serde(default = "yes")]
    pub board: bool,
}

const fn yes() -> bool {
    true
}

impl StudentConfig {
    /// Number of patches that influence an output of the encoder.
    #[must_use]
    pub(crate) fn receptive_field(&self) -> usize {
        self.layers * self.span.saturating_sub(1) + 1
    }

    /// A model with random weights for `classes` intents.
    #[must_use]
    pub fn init(&self, classes: usize, device: &Device) -> Student {
        let d = self.d_model;
        let layer = || StudentLayer {
            norm1: LayerNormConfig::new(d).init(device),
            qkv: LinearConfig::new(d, 3 * d).init(device),
            relative_bias: Initializer::Zeros.init([self.heads, self.span], device),
            out: LinearConfig::new(d, d).init(device),
            norm2: LayerNormConfig::new(d).init(device),
            ff1: LinearConfig::new(d, 2 * d).init(device),
            ff2: LinearConfig::new(2 * d, d).init(device),
            heads: self.heads,
            span: self.span,
        };
        Student {
            embed: LinearConfig::new(CHANNELS * PATCH, d).init(device),
            layers: (0..self.layers).map(|_| layer()).collect(),
            final_norm: LayerNormConfig::new(d).init(device),
            head: LinearConfig::new(d, LOOK_BACK * classes).init(device),
            square_root: self.companding == Companding::SquareRoot,
        }
    }
}

/// The streaming encoder with its look-back head.
#[derive(Module, Debug)]
pub struct Student {
    /// Patch embedding: 80 inputs to a token.
    pub(super) embed: Linear,
    /// The encoder's layers.
    pub(super) layers: Vec<StudentLayer>,
    /// Norm before the head.
    pub(super) final_norm: LayerNorm,
    /// Look-back head: a token to `6 * classes` logits, newest patch first.
    pub(super) head: Linear,
    square_root: bool,
}

/// One pre-norm layer with local causal attention.
#[derive(Module, Debug)]
pub(super) struct StudentLayer {
    /// Before attention.
    pub(super) norm1: LayerNorm,
    /// Queries, keys and values, in this order.
    pub(super) qkv: Linear,
    /// Relative-position bias of the scores, by the distance of the key in patches, `[heads, span]`.
    pub(super) relative_bias: Param<Tensor<2>>,
    /// After attention.
    pub(super) out: Linear,
    /// Before the feed-forward block.
    pub(super) norm2: LayerNorm,
    /// d to 2d.
    pub(super) ff1: Linear,
    /// 2d to d.
    pub(super) ff2: Linear,
    heads: usize,
    span: usize,
}

impl Student {
    /// Logits of the look-back head at every patch, `[b, patches, 6, classes]`, newest first.
    ///
    /// `emg` is cleaned EMG over 128, `[b, patches, 80]`, sample after sample.
    #[must_use]
    pub(crate) fn forward(&self, emg: Tensor<3>) -> Tensor<4> {
        let [batch, patches, _] = emg.dims();
        // The root has no derivative at 0, but the input needs no gradient.
        let emg = if self.square_root { emg.sqrt() } else { emg };
        let mut x = self.embed.forward(emg);
        for layer in &self.layers {
            x = layer.forward(x);
        }
        let logits = self.head.forward(self.final_norm.forward(x));
        let [_, _, outputs] = logits.dims();
        logits.reshape([batch, patches, LOOK_BACK, outputs / LOOK_BACK])
    }
}

impl StudentLayer {
    fn forward(&self, x: Tensor<3>) -> Tensor<3> {
        let x = x.clone() + self.attention(self.norm1.forward(x));
        let hidden = self.ff1.forward(self.norm2.forward(x.clone()));
        // GELU in its sigmoid approximation: one exponential and one division on the device.
        let hidden = hidden.clone() * sigmoid(hidden * 1.702);
        x + self.ff2.forward(hidden)
    }

    fn attention(&self, x: Tensor<3>) -> Tensor<3> {
        let [batch, patches, d] = x.dims();
        let width = d / self.heads;
        let qkv = self
            .qkv
            .forward(x)
            .reshape([batch, patches, 3, self.heads, width])
            .permute([2, 0, 3, 1, 4]);
        let part = |i: usize| qkv.clone().slice_dim(0, i..i + 1).squeeze_dim::<4>(0);
        let query = part(0) * (1.0 / (width as f32).sqrt());
        let scores = query.matmul(part(1).swap_dims(2, 3)) + self.band(patches);
        let attended = softmax(scores, 3)
            .matmul(part(2))
            .swap_dims(1, 2)
            .reshape([batch, patches, d]);
        self.out.forward(attended)
    }

    /// Relative-position bias inside the band, -1e9 outside, `[1, heads, n, n]`.
    fn band(&self, patches: usize) -> Tensor<4> {
        let device = self.relative_bias.val().device();
        let mut distance = Vec::with_capacity(patches * patches);
        let mut outside = Vec::with_capacity(patches * patches);
        for query in 0..patches {
            for key in 0..patches {
                let inside = key <= query && query - key < self.span;
                distance.push(if inside { (query - key) as i32 } else { 0 });
                outside.push(if inside { 0.0_f32 } else { -1e9 });
            }
        }
        let cells = patches * patches;
        let distance = Tensor::<1, Int>::from_data(TensorData::new(distance, [cells]), &device);
        let outside =
            Tensor::<4>::from_data(TensorData::new(outside, [1, 1, patches, patches]), &device);
        self.relative_bias
            .val()
            .select(1, distance)
            .reshape([1, self.heads, patches, patches])
            + outside
    }
}
