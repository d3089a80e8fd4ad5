//! The masked transformer over EMG and intent tokens.
//!
//! With a patch of 1 this is the paper's network, layer by layer. With a larger patch, that many samples
//! are one token; fewer tokens make training on a CPU feasible. Everything else is the same code.

use burn::module::{Module, Param};
use burn::nn::{Initializer, LayerNorm, LayerNormConfig, Linear, LinearConfig};
use burn::tensor::{Device, Tensor, TensorData};
use rand_chacha::ChaCha8Rng;
use shared::model::dimensions::Companding;
use shared::units::CHANNELS;

use super::attention::attend;
use super::feed_forward::activate;
use crate::optimization::dropout::Dropout;
use crate::optimization::initial;
pub use presets::teacher::{TeacherConfig, WindowShape};

/// Initial values of the learned positional encoding: sinusoids of many wavelengths. From random values, a short training
/// does not learn which EMG token belongs to which intent token.
fn sinusoids(tokens: usize, d: usize, device: &Device) -> Tensor<2> {
    let values: Vec<f32> = (0..tokens * d)
        .map(|at| {
            let (token, feature) = ((at / d) as f32, at % d);
            let wavelength = 1000.0_f32.powf((feature / 2 * 2) as f32 / d as f32);
            let phase = token / wavelength;
            if feature % 2 == 0 {
                phase.sin()
            } else {
                phase.cos()
            }
        })
        .collect();
    Tensor::from_data(TensorData::new(values, [tokens, d]), device)
}

/// Model of the paper: the EMG tokens and the intent tokens of a window, concatenated and encoded together.
#[derive(Module, Debug)]
pub struct Teacher {
    emg_embedding: Linear,
    emg_norm: LayerNorm,
    emg_mask: Param<Tensor<1>>,
    emg_modality: Param<Tensor<1>>,
    intent_modality: Param<Tensor<1>>,
    position: Param<Tensor<2>>,
    intent_embedding: Param<Tensor<2>>,
    layers: Vec<TeacherLayer>,
    emg_head: Linear,
    intent_head: Linear,
    square_root: bool,
}

/// Pre-norm encoder layer.
#[derive(Module, Debug)]
pub(super) struct TeacherLayer {
    norm1: LayerNorm,
    qkv: Linear,
    out: Linear,
    norm2: LayerNorm,
    linear1: Linear,
    linear2: Linear,
    dropout: f64,
    attention_dropout: f64,
    heads: usize,
}

impl Teacher {
    /// Creates a model for `classes` intents, and MASK as one more class, with the random weights of a seed.
    pub fn new(seed: u64, config: &TeacherConfig, classes: usize, device: &Device) -> Self {
        let d = config.d_model;
        let small = Initializer::Normal {
            mean: 0.0,
            std: 0.02,
        };
        initial(seed, device, || Self {
            emg_embedding: LinearConfig::new(CHANNELS * config.patch, d).init(device),
            emg_norm: LayerNormConfig::new(d).init(device),
            emg_mask: small.init([d], device),
            emg_modality: small.init([d], device),
            intent_modality: small.init([d], device),
            position: Param::from_tensor(sinusoids(config.window_shape().tokens(), d, device)),
            intent_embedding: Initializer::Normal {
                mean: 0.0,
                std: 1.0,
            }
            .init([classes + 1, d], device),
            layers: (0..config.layers)
                .map(|_| TeacherLayer::new(config, device))
                .collect(),
            emg_head: LinearConfig::new(d, CHANNELS * config.patch).init(device),
            intent_head: LinearConfig::new(d, (classes + 1) * config.patch).init(device),
            square_root: config.companding == Companding::SquareRoot,
        })
    }
}

impl TeacherLayer {
    fn new(config: &TeacherConfig, device: &Device) -> Self {
        let d = config.d_model;
        Self {
            norm1: LayerNormConfig::new(d).init(device),
            qkv: LinearConfig::new(d, 3 * d).init(device),
            out: LinearConfig::new(d, d).init(device),
            norm2: LayerNormConfig::new(d).init(device),
            linear1: LinearConfig::new(d, config.feed_forward).init(device),
            linear2: LinearConfig::new(config.feed_forward, d).init(device),
            dropout: config.dropout,
            attention_dropout: config.attention_dropout,
            heads: config.heads,
        }
    }
}

/// A teacher's input: a batch of `b` windows in tokens of `patch` samples.
#[derive(Clone, Debug)]
pub struct TeacherInput {
    /// Cleaned EMG over 128, `[b, tokens, patch * 8]`, sample after sample.
    pub emg: Tensor<3>,
    /// Mask with 1 where the token's EMG is masked, `[b, tokens, 1]`.
    pub emg_mask: Tensor<3>,
    /// Fraction of the token's samples in each class, MASK last, `[b, tokens, classes + 1]`.
    pub intent: Tensor<3>,
    /// Mask with 1 for windows without attention between EMG and intents (self-supervised), `[b]`; `None` without such windows.
    pub blocked: Option<Tensor<1>>,
}

impl TeacherInput {
    /// Input for inference: whole EMG, every intent masked. `emg` is of whole windows.
    pub fn for_inference(
        emg: Vec<f32>,
        shape: WindowShape,
        classes: usize,
        device: &Device,
    ) -> Self {
        let (tokens, patch) = (shape.tokens(), shape.patch);
        let b = emg.len() / (shape.window * CHANNELS);
        let mut intent = vec![0.0_f32; b * tokens * (classes + 1)];
        for token in intent.chunks_exact_mut(classes + 1) {
            token[classes] = 1.0;
        }
        Self {
            emg: Tensor::from_data(TensorData::new(emg, [b, tokens, patch * CHANNELS]), device),
            emg_mask: Tensor::zeros([b, tokens, 1], device),
            intent: Tensor::from_data(TensorData::new(intent, [b, tokens, classes + 1]), device),
            blocked: None,
        }
    }
}

/// A teacher's output.
#[derive(Clone, Debug)]
pub struct TeacherOutput {
    /// Reconstructed EMG, `[b, tokens, patch * 8]`.
    pub emg: Tensor<3>,
    /// Logits per sample, MASK last, `[b, window, classes + 1]`.
    pub intent: Tensor<3>,
}

impl Teacher {
    /// Computes the outputs for a batch of windows, without dropout.
    pub fn forward(&self, input: TeacherInput) -> TeacherOutput {
        self.run(input, &mut Dropout::off())
    }

    /// Computes the outputs with dropout. The caller's generator makes the masks, so that batches on several threads stay
    /// reproducible.
    pub(super) fn forward_dropping(&self, input: TeacherInput, rng: ChaCha8Rng) -> TeacherOutput {
        self.run(input, &mut Dropout::from(rng))
    }

    fn run(&self, input: TeacherInput, dropout: &mut Dropout) -> TeacherOutput {
        let [batch, tokens, width] = input.emg.dims();
        let [classes, d] = self.intent_embedding.dims();
        let position = self.position.val().unsqueeze::<3>();

        let emg = if self.square_root {
            input.emg.sqrt()
        } else {
            input.emg
        };
        // As in the reference, the mask vector replaces the token after the layer norm.
        let emg = self.emg_norm.forward(self.emg_embedding.forward(emg));
        let masked = input.emg_mask.clone() * self.emg_mask.val().reshape([1, 1, d]);
        let emg = emg * (input.emg_mask * -1.0 + 1.0)
            + masked
            + self.emg_modality.val().reshape([1, 1, d])
            + position.clone();

        let intent = input
            .intent
            .reshape([batch * tokens, classes])
            .matmul(self.intent_embedding.val())
            .reshape([batch, tokens, d])
            + self.intent_modality.val().reshape([1, 1, d])
            + position;

        let mut x = Tensor::cat(vec![emg, intent], 1);
        for layer in &self.layers {
            x = layer.forward(x, input.blocked.as_ref(), dropout);
        }
        let emg = x.clone().slice([0..batch, 0..tokens]);
        let intent = x.slice([0..batch, tokens..2 * tokens]);
        TeacherOutput {
            emg: self.emg_head.forward(emg),
            intent: self.intent_head.forward(intent).reshape([
                batch,
                tokens * width / CHANNELS,
                classes,
            ]),
        }
    }

    /// Number of encoder layers.
    pub(super) fn depth(&self) -> usize {
        self.layers.len()
    }

    /// Number of output classes, MASK included.
    pub(crate) fn classes(&self) -> usize {
        self.intent_embedding.dims()[0]
    }
}

impl TeacherLayer {
    fn forward(
        &self,
        x: Tensor<3>,
        blocked: Option<&Tensor<1>>,
        dropout: &mut Dropout,
    ) -> Tensor<3> {
        let qkv = self.qkv.forward(self.norm1.forward(x.clone()));
        let mask = dropout.mask(self.attention_dropout);
        let attended = self.out.forward(attend(qkv, self.heads, blocked, mask));
        let x = x + dropout.drop(attended, self.dropout);
        let hidden = self.linear1.forward(self.norm2.forward(x.clone()));
        let hidden = self
            .linear2
            .forward(activate(hidden, dropout.mask(self.dropout)));
        x + dropout.drop(hidden, self.dropout)
    }
}
