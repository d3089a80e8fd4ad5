//! Linear layers and layer norms of the tokens of one sequence, forward and backward.

use pulp::Simd;

use super::parameters::{Linear, Norm};
use crate::optimization::kernels::matmul::{MatrixRows, RowsMut, Transposed, product};
use crate::optimization::kernels::{dot, fold};
use crate::student::model::NORM_EPSILON;

/// Adds a linear layer's output to `to` (`ADD`), or writes it there.
#[inline(always)]
pub(super) fn linear<S: Simd, const ADD: bool>(
    simd: S,
    to: &mut [f32],
    x: &[f32],
    layer: &Linear<&[f32]>,
) {
    let outputs = layer.bias.len();
    let inputs = layer.weight.len() / outputs;
    for to in to.chunks_exact_mut(outputs) {
        if ADD {
            for (to, bias) in to.iter_mut().zip(layer.bias) {
                *to += bias;
            }
        } else {
            to.copy_from_slice(layer.bias);
        }
    }
    let sizes = [to.len() / outputs, inputs, outputs];
    let weight = matrix(layer.weight, outputs);
    product::<S, true>(
        simd,
        matrix_mut(to, outputs),
        matrix(x, inputs),
        weight,
        sizes,
    );
}

/// Adds the gradients of a linear layer's parameters, given the gradient of its output.
#[inline(always)]
pub(super) fn linear_parameters<S: Simd>(
    simd: S,
    gradients: &mut Linear<&mut [f32]>,
    x: &[f32],
    gradient: &[f32],
) {
    let outputs = gradients.bias.len();
    let inputs = gradients.weight.len() / outputs;
    for row in gradient.chunks_exact(outputs) {
        for (sum, gradient) in gradients.bias.iter_mut().zip(row) {
            *sum += gradient;
        }
    }
    let sizes = [inputs, gradient.len() / outputs, outputs];
    let to = matrix_mut(gradients.weight, outputs);
    let x = Transposed(matrix(x, inputs));
    product::<S, true>(simd, to, x, matrix(gradient, outputs), sizes);
}

/// Writes the gradient of a linear layer's input; `transpose` is the weight, outputs by inputs.
#[inline(always)]
pub(super) fn linear_input<S: Simd>(
    simd: S,
    to: &mut [f32],
    gradient: &[f32],
    transpose: &[f32],
    outputs: usize,
) {
    let inputs = transpose.len() / outputs;
    let sizes = [gradient.len() / outputs, outputs, inputs];
    let gradient = matrix(gradient, outputs);
    let transpose = matrix(transpose, inputs);
    product::<S, false>(simd, matrix_mut(to, inputs), gradient, transpose, sizes);
}

/// Values that a layer norm's backward pass needs.
#[derive(Clone, Debug, Default)]
pub(super) struct Normalized {
    /// Normalized tokens, of mean 0 and variance 1, `[tokens, d]`.
    values: Vec<f32>,
    /// Reciprocal of each token's standard deviation before normalization.
    inverse: Vec<f32>,
}

impl Normalized {
    pub(super) fn new(tokens: usize, d: usize) -> Self {
        Self {
            values: vec![0.0; tokens * d],
            inverse: vec![0.0; tokens],
        }
    }

    /// Normalizes tokens, and writes the norm's output.
    #[inline(always)]
    pub(super) fn forward(&mut self, x: &[f32], norm: &Norm<&[f32]>, to: &mut [f32]) {
        let d = norm.gain.len();
        let share = 1.0 / d as f32;
        let rows = x.chunks_exact(d).zip(self.values.chunks_exact_mut(d));
        for ((x, values), inverse) in rows.zip(&mut self.inverse) {
            let mean = fold(x, 0.0, |a, b| a + b) * share;
            for (value, x) in values.iter_mut().zip(x) {
                *value = x - mean;
            }
            let variance = dot(values, values) * share;
            *inverse = 1.0 / (variance + NORM_EPSILON as f32).sqrt();
            for value in values {
                *value *= *inverse;
            }
        }
        self.output(norm, to);
    }

    /// Writes the norm's output.
    #[inline(always)]
    pub(super) fn output(&self, norm: &Norm<&[f32]>, to: &mut [f32]) {
        let d = norm.gain.len();
        for (to, values) in to.chunks_exact_mut(d).zip(self.values.chunks_exact(d)) {
            for (at, to) in to.iter_mut().enumerate() {
                *to = values[at] * norm.gain[at] + norm.bias[at];
            }
        }
    }

    /// Adds the gradients of the norm's parameters, and of its input (to `to`), given the gradient of its output, which is
    /// overwritten.
    #[inline(always)]
    pub(super) fn backward(
        &self,
        norm: &Norm<&[f32]>,
        gradients: &mut Norm<&mut [f32]>,
        gradient: &mut [f32],
        to: &mut [f32],
    ) {
        let d = norm.gain.len();
        let share = 1.0 / d as f32;
        let rows = gradient.chunks_exact_mut(d).zip(to.chunks_exact_mut(d));
        let normalized = self.values.chunks_exact(d).zip(&self.inverse);
        for ((gradient, to), (values, inverse)) in rows.zip(normalized) {
            let gains = gradients.gain.iter_mut().zip(&mut *gradients.bias);
            for (at, (gain, bias)) in gains.enumerate() {
                *gain += gradient[at] * values[at];
                *bias += gradient[at];
                gradient[at] *= norm.gain[at];
            }
            let mean = fold(gradient, 0.0, |a, b| a + b) * share;
            let slope = dot(gradient, values) * share;
            for (at, to) in to.iter_mut().enumerate() {
                *to += (gradient[at] - mean - values[at] * slope) * inverse;
            }
        }
    }
}

#[inline(always)]
pub(super) fn matrix(values: &[f32], stride: usize) -> MatrixRows<'_> {
    MatrixRows { values, stride }
}

#[inline(always)]
pub(super) fn matrix_mut(values: &mut [f32], stride: usize) -> RowsMut<'_> {
    RowsMut { values, stride }
}
