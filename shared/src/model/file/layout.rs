//! The tensors, borrowed from the file.

use crate::model::dimensions::MAX_LAYERS;

/// A linear map: `y[r] = scales[r] * sum over c of weights[r][c] / 256 x[c] + bias[r]`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LinearWeights<'m> {
    /// `[outputs][inputs]` in the tiles of [`Kernels::multiply`](crate::kernels::Kernels::multiply).
    pub weights: &'m [i8],
    /// Largest magnitude of an input's codes ([`code_limit`](crate::kernels::code_limit)).
    pub code_limit: i16,
    /// Scales, one per output.
    pub scales: &'m [f32],
    /// Bias, one per output.
    pub bias: &'m [f32],
}

/// Parameters of a layer norm, `[d]` each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NormWeights<'m> {
    /// Factors.
    pub gain: &'m [f32],
    /// Terms.
    pub bias: &'m [f32],
}

/// Tensors of one pre-norm layer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LayerWeights<'m> {
    /// Norm before attention.
    pub norm1: NormWeights<'m>,
    /// d -> 3d: query, key, value.
    pub qkv: LinearWeights<'m>,
    /// `[heads][span]`: added to the score of a patch, by its age in patches.
    pub relative_bias: &'m [f32],
    /// d -> d: after attention.
    pub out: LinearWeights<'m>,
    /// Norm before the feed-forward.
    pub norm2: NormWeights<'m>,
    /// d -> 2d.
    pub ff1: LinearWeights<'m>,
    /// 2d -> d.
    pub ff2: LinearWeights<'m>,
}

/// All tensors of a model.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Weights<'m> {
    /// 80 -> d: the patch, sample by sample.
    pub embed: LinearWeights<'m>,
    /// The layers; empty from the model's number of layers on.
    pub layers: [LayerWeights<'m>; MAX_LAYERS],
    /// Norm before the head.
    pub final_norm: NormWeights<'m>,
    /// d -> 6 x row outputs: those of the newest patch first.
    pub head: LinearWeights<'m>,
}
