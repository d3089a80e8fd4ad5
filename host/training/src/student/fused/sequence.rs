//! Forward and backward pass of the network on one sequence; all buffers together fit into the cache of a core.

use pulp::Simd;

use super::attention::Buffers;
use super::linear::{Normalized, linear, linear_input, linear_parameters};
use super::parameters::{Layer, Parameters, Sizes, Transposes};
use crate::optimization::kernels::exponential::exp_negative;
use crate::optimization::kernels::matmul::padded;
use crate::optimization::kernels::softmax::RowStatistics;
use crate::student::model::GELU_SCALE;

/// Values that the backward pass of a sequence needs.
#[derive(Clone, Debug)]
pub(super) struct Saved {
    layers: Vec<SavedLayer>,
    final_norm: Normalized,
}

/// Values that the backward pass of a layer needs.
#[derive(Clone, Debug)]
struct SavedLayer {
    norm1: Normalized,
    qkv: Vec<f32>,
    statistics: Vec<RowStatistics>,
    attended: Vec<f32>,
    norm2: Normalized,
    /// Input of the activation.
    hidden: Vec<f32>,
}

impl Saved {
    pub(super) fn new(sizes: Sizes, tokens: usize) -> Self {
        let Sizes { d, heads, .. } = sizes;
        let layer = || SavedLayer {
            norm1: Normalized::new(tokens, d),
            qkv: vec![0.0; tokens * 3 * sizes.attended()],
            statistics: vec![RowStatistics::default(); heads * tokens],
            attended: vec![0.0; tokens * sizes.attended()],
            norm2: Normalized::new(tokens, d),
            hidden: vec![0.0; tokens * sizes.hidden()],
        };
        Self {
            layers: (0..sizes.layers).map(|_| layer()).collect(),
            final_norm: Normalized::new(tokens, d),
        }
    }
}

/// Buffers that are reused from sequence to sequence.
pub(super) struct Scratch {
    sizes: Sizes,
    attention: Buffers,
    input: Vec<f32>,
    /// Residual stream, or its gradient.
    x: Vec<f32>,
    /// Output of a norm, or its gradient.
    normalized: Vec<f32>,
    normalized_gradient: Vec<f32>,
    /// Output and slope of the activation.
    activated: Vec<f32>,
    slope: Vec<f32>,
    hidden_gradient: Vec<f32>,
    attended_gradient: Vec<f32>,
    qkv_gradient: Vec<f32>,
    /// Logits with padding.
    logits: Vec<f32>,
}

impl Scratch {
    pub(super) fn new(sizes: Sizes, tokens: usize) -> Self {
        let values = |width: usize| vec![0.0; tokens * width];
        Self {
            sizes,
            attention: Buffers::new(sizes, tokens),
            input: values(sizes.inputs),
            x: values(sizes.d),
            normalized: values(sizes.d),
            normalized_gradient: values(sizes.d),
            activated: values(sizes.hidden()),
            slope: values(sizes.hidden()),
            hidden_gradient: values(sizes.hidden()),
            attended_gradient: values(sizes.attended()),
            qkv_gradient: values(3 * sizes.attended()),
            logits: values(padded(sizes.outputs)),
        }
    }

    #[inline(always)]
    fn load(&mut self, emg: &[f32]) {
        if self.sizes.square_root {
            for (to, from) in self.input.iter_mut().zip(emg) {
                *to = from.sqrt();
            }
        } else {
            self.input.copy_from_slice(emg);
        }
    }

    /// Writes a sequence's logits, `[tokens, outputs]`.
    #[inline(always)]
    pub(super) fn forward<S: Simd>(
        &mut self,
        simd: S,
        parameters: &Parameters<&[f32]>,
        emg: &[f32],
        saved: &mut Saved,
        logits: &mut [f32],
    ) {
        self.load(emg);
        linear::<S, false>(simd, &mut self.x, &self.input, &parameters.embed);
        for (layer, saved) in parameters.layers.iter().zip(&mut saved.layers) {
            let (x, normalized) = (&mut self.x, &mut self.normalized);
            saved.norm1.forward(x, &layer.norm1, normalized);
            linear::<S, false>(simd, &mut saved.qkv, normalized, &layer.qkv);
            let (attended, statistics) = (&mut saved.attended, &mut saved.statistics);
            self.attention
                .forward(simd, &saved.qkv, layer.relative_bias, attended, statistics);
            linear::<S, true>(simd, x, attended, &layer.out);
            saved.norm2.forward(x, &layer.norm2, normalized);
            linear::<S, false>(simd, &mut saved.hidden, normalized, &layer.ff1);
            activate(&saved.hidden, &mut self.activated);
            linear::<S, true>(simd, x, &self.activated, &layer.ff2);
        }
        let normalized = &mut self.normalized;
        saved
            .final_norm
            .forward(&self.x, &parameters.final_norm, normalized);
        linear::<S, false>(simd, &mut self.logits, normalized, &parameters.head);
        let rows = self.logits.chunks_exact(padded(self.sizes.outputs));
        for (to, from) in logits.chunks_exact_mut(self.sizes.outputs).zip(rows) {
            to.copy_from_slice(&from[..to.len()]);
        }
    }

    /// Adds the gradients of the parameters, given the gradients of a sequence's logits.
    #[inline(always)]
    pub(super) fn backward<S: Simd>(
        &mut self,
        simd: S,
        (parameters, transposes): (&Parameters<&[f32]>, &Transposes),
        (emg, logits): (&[f32], &[f32]),
        saved: &Saved,
        gradients: &mut Parameters<&mut [f32]>,
    ) {
        let outputs = padded(self.sizes.outputs);
        let rows = self.logits.chunks_exact_mut(outputs);
        for (to, from) in rows.zip(logits.chunks_exact(self.sizes.outputs)) {
            // The padding's gradients stay 0, as when the buffer was created.
            to[..from.len()].copy_from_slice(from);
        }
        let (norm, gradient) = (&parameters.final_norm, &mut self.normalized_gradient);
        saved.final_norm.output(norm, &mut self.normalized);
        linear_parameters(simd, &mut gradients.head, &self.normalized, &self.logits);
        linear_input(simd, gradient, &self.logits, &transposes.head, outputs);
        self.x.fill(0.0);
        saved
            .final_norm
            .backward(norm, &mut gradients.final_norm, gradient, &mut self.x);
        for layer in (0..self.sizes.layers).rev() {
            let (saved, gradients) = (&saved.layers[layer], &mut gradients.layers[layer]);
            let (layer, transposes) = (&parameters.layers[layer], &transposes.layers[layer]);
            let [qkv, out, ff1, ff2] = [
                &transposes.qkv,
                &transposes.out,
                &transposes.ff1,
                &transposes.ff2,
            ];
            self.feed_forward_backward(simd, layer, [ff1, ff2], saved, gradients);
            self.attention_backward(simd, layer, [qkv, out], saved, gradients);
        }
        self.load(emg);
        linear_parameters(simd, &mut gradients.embed, &self.input, &self.x);
    }

    /// Backward pass of a layer's feed-forward block; updates the residual stream's gradient.
    #[inline(always)]
    fn feed_forward_backward<S: Simd>(
        &mut self,
        simd: S,
        layer: &Layer<&[f32]>,
        [ff1, ff2]: [&[f32]; 2],
        saved: &SavedLayer,
        gradients: &mut Layer<&mut [f32]>,
    ) {
        let (d, hidden) = (self.sizes.d, self.sizes.hidden());
        let (x, normalized) = (&mut self.x, &mut self.normalized);
        let (hidden_gradient, gradient) =
            (&mut self.hidden_gradient, &mut self.normalized_gradient);
        activate_with_slope(&saved.hidden, &mut self.activated, &mut self.slope);
        linear_parameters(simd, &mut gradients.ff2, &self.activated, x);
        linear_input(simd, hidden_gradient, x, ff2, d);
        for (gradient, slope) in hidden_gradient.iter_mut().zip(&self.slope) {
            *gradient *= slope;
        }
        saved.norm2.output(&layer.norm2, normalized);
        linear_parameters(simd, &mut gradients.ff1, normalized, hidden_gradient);
        linear_input(simd, gradient, hidden_gradient, ff1, hidden);
        saved
            .norm2
            .backward(&layer.norm2, &mut gradients.norm2, gradient, x);
    }

    /// Backward pass of a layer's attention; updates the residual stream's gradient.
    #[inline(always)]
    fn attention_backward<S: Simd>(
        &mut self,
        simd: S,
        layer: &Layer<&[f32]>,
        [qkv, out]: [&[f32]; 2],
        saved: &SavedLayer,
        gradients: &mut Layer<&mut [f32]>,
    ) {
        let (x, normalized) = (&mut self.x, &mut self.normalized);
        let (attended_gradient, gradient) =
            (&mut self.attended_gradient, &mut self.normalized_gradient);
        linear_parameters(simd, &mut gradients.out, &saved.attended, x);
        linear_input(simd, attended_gradient, x, out, self.sizes.d);
        self.attention.backward(
            simd,
            [&saved.qkv, layer.relative_bias, attended_gradient],
            &saved.statistics,
            &mut self.qkv_gradient,
            gradients.relative_bias,
        );
        saved.norm1.output(&layer.norm1, normalized);
        linear_parameters(simd, &mut gradients.qkv, normalized, &self.qkv_gradient);
        let outputs = 3 * self.sizes.attended();
        linear_input(simd, gradient, &self.qkv_gradient, qkv, outputs);
        saved
            .norm1
            .backward(&layer.norm1, &mut gradients.norm1, gradient, x);
    }
}

/// Writes GELU of `x` in its sigmoid approximation, `x sigmoid(1.702 x)`.
#[inline(always)]
fn activate(x: &[f32], to: &mut [f32]) {
    for (to, &x) in to.iter_mut().zip(x) {
        *to = x * sigmoid(GELU_SCALE * x);
    }
}

/// Writes [`activate`] of `x`, and its slope.
#[inline(always)]
fn activate_with_slope(x: &[f32], to: &mut [f32], slope: &mut [f32]) {
    for ((to, slope), &x) in to.iter_mut().zip(slope).zip(x) {
        let sigmoid = sigmoid(GELU_SCALE * x);
        *to = x * sigmoid;
        *slope = sigmoid + GELU_SCALE * *to * (1.0 - sigmoid);
    }
}

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    let small = exp_negative(-x.abs());
    let share = 1.0 / (1.0 + small);
    if x < 0.0 { small * share } else { share }
}
