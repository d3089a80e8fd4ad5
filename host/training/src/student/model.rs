//! Dimensions and parameters of the float twin of the device's streaming encoder
//! (`shared::model::encoder`), for training.

use burn::module::{Module, Param};
use burn::nn::{Initializer, LayerNorm, LayerNormConfig, Linear, LinearConfig};
use burn::tensor::{Device, Tensor};
use shared::model::dimensions::Companding;
use shared::units::{CHANNELS, LOOK_BACK, PATCH};

use crate::optimization::initial;
pub use presets::distillation::StudentConfig;

/// Constant added to a variance before its root is taken.
pub(super) const NORM_EPSILON: f64 = 1e-5;

/// Scale of the sigmoid that approximates GELU.
pub(super) const GELU_SCALE: f32 = 1.702;

/// Number of attention heads of every model file.
pub(super) const HEADS: usize = 4;

/// The streaming encoder with its look-back head.
#[derive(Module, Debug)]
pub struct Student {
    /// Patch embedding, from 80 inputs to a token.
    pub(super) embed: Linear,
    /// Encoder layers.
    pub(super) layers: Vec<StudentLayer>,
    /// Layer norm before the head.
    pub(super) final_norm: LayerNorm,
    /// Look-back head, from a token to the logits of six rows, newest patch first.
    pub(super) head: Linear,
    /// Whether the last logit of a row is movement outside the vocabulary.
    pub(crate) other: bool,
    pub(super) square_root: bool,
}

impl Student {
    /// Creates a model for `classes` intents and, with `other`, other movement, with the random weights of a seed.
    pub fn new(
        seed: u64,
        config: &StudentConfig,
        classes: usize,
        other: bool,
        device: &Device,
    ) -> Self {
        let d = config.d_model;
        let norm = || {
            LayerNormConfig::new(d)
                .with_epsilon(NORM_EPSILON)
                .init(device)
        };
        let layer = || StudentLayer {
            norm1: norm(),
            qkv: LinearConfig::new(d, 3 * d).init(device),
            relative_bias: Initializer::Zeros.init([config.heads, config.span], device),
            out: LinearConfig::new(d, d).init(device),
            norm2: norm(),
            ff1: LinearConfig::new(d, 2 * d).init(device),
            ff2: LinearConfig::new(2 * d, d).init(device),
            heads: config.heads,
            span: config.span,
        };
        initial(seed, device, || Self {
            embed: LinearConfig::new(CHANNELS * PATCH, d).init(device),
            layers: (0..config.layers).map(|_| layer()).collect(),
            final_norm: norm(),
            head: LinearConfig::new(d, LOOK_BACK * (classes + usize::from(other))).init(device),
            other,
            square_root: config.companding == Companding::SquareRoot,
        })
    }
}

/// Pre-norm layer with local causal attention.
#[derive(Module, Debug)]
pub(super) struct StudentLayer {
    /// Layer norm before attention.
    pub(super) norm1: LayerNorm,
    /// Queries, keys and values, in this order.
    pub(super) qkv: Linear,
    /// Relative-position bias of the scores, by the distance of the key in patches, `[heads, span]`.
    pub(super) relative_bias: Param<Tensor<2>>,
    /// Linear map after attention.
    pub(super) out: Linear,
    /// Layer norm before the feed-forward block.
    pub(super) norm2: LayerNorm,
    /// First linear map of the feed-forward block, d to 2d.
    pub(super) ff1: Linear,
    /// Second linear map of the feed-forward block, 2d to d.
    pub(super) ff2: Linear,
    pub(super) heads: usize,
    pub(super) span: usize,
}
