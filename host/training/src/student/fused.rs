//! The student as one operation of the CPU backend, sequence by sequence.
//!
//! Burn's operations write every intermediate tensor of a batch to memory, attention over all pairs of patches among them,
//! and read it again. Here the tensors of one sequence fit into the cache of a core, and attention is computed only inside
//! the band. The order of all sums is fixed: the result does not depend on the number of threads.

mod attention;
mod linear;
mod operation;
mod parameters;
mod sequence;

use burn::backend::Dispatch;
use burn::nn::{LayerNorm, Linear};
use burn::tensor::Tensor;
use operation::FusedStudent as _;
use parameters::Sizes;

use super::model::Student;
use crate::optimization::kernels::is_flex;
use crate::optimization::kernels::matmul::padded;

/// Computes the logits of all outputs, `[b, patches, outputs]`; none if the operation does not apply: it needs the CPU
/// backend and a width of whole vectors. `emg` gets no gradient.
pub(super) fn forward(student: &Student, emg: &Tensor<3>) -> Option<Tensor<3>> {
    let [_, patches, inputs] = emg.dims();
    let [embedded, d] = student.embed.weight.dims();
    let [_, outputs] = student.head.weight.dims();
    let first = student.layers.first()?;
    let [heads, span] = first.relative_bias.dims();
    let fits =
        is_flex(emg) && patches > 0 && inputs == embedded && d == padded(d) && d % heads == 0;
    if !fits || emg.is_require_grad() {
        return None;
    }
    let sizes = Sizes {
        inputs,
        d,
        heads,
        layers: student.layers.len(),
        span,
        outputs,
        square_root: student.square_root,
    };
    let logits = Dispatch::fused_student(
        emg.clone().into_dispatch(),
        parameters(student, sizes).into_dispatch(),
        sizes,
    );
    Some(Tensor::from_dispatch(logits))
}

/// Concatenates all parameters, in the order and with the padding of [`parameters::Parameters`].
fn parameters(student: &Student, sizes: Sizes) -> Tensor<1> {
    let mut rows = Vec::new();
    linear(&mut rows, &student.embed, |x| x);
    for layer in &student.layers {
        norm(&mut rows, &layer.norm1);
        linear(&mut rows, &layer.qkv, |x| {
            let [inputs, _] = x.dims();
            let width = sizes.head();
            pad(x.reshape([inputs * 3 * sizes.heads, width]), 1).reshape([inputs as i32, -1])
        });
        rows.push(layer.relative_bias.val().flatten(0, 1));
        let (weight, bias) = parts(&layer.out);
        let by_head = weight.reshape([sizes.heads, sizes.head(), sizes.d]);
        rows.push(pad(by_head, 1).flatten(0, 2));
        rows.push(bias);
        norm(&mut rows, &layer.norm2);
        linear(&mut rows, &layer.ff1, |x| x);
        linear(&mut rows, &layer.ff2, |x| x);
    }
    norm(&mut rows, &student.final_norm);
    linear(&mut rows, &student.head, |x| pad(x, 1));
    Tensor::cat(rows, 0)
}

/// Appends a layer's weight and bias, each `[rows, outputs]` and changed by `arrange`.
fn linear(rows: &mut Vec<Tensor<1>>, layer: &Linear, arrange: impl Fn(Tensor<2>) -> Tensor<2>) {
    let (weight, bias) = parts(layer);
    rows.push(arrange(weight).flatten(0, 1));
    rows.push(arrange(bias.unsqueeze_dim(0)).flatten(0, 1));
}

/// Weight and bias of a layer.
fn parts(layer: &Linear) -> (Tensor<2>, Tensor<1>) {
    let weight = layer.weight.val();
    let [_, outputs] = weight.dims();
    let bias = match &layer.bias {
        Some(bias) => bias.val(),
        None => Tensor::zeros([outputs], &weight.device()),
    };
    (weight, bias)
}

fn norm(rows: &mut Vec<Tensor<1>>, norm: &LayerNorm) {
    let gain = norm.gamma.val();
    let bias = match &norm.beta {
        Some(bias) => bias.val(),
        None => gain.zeros_like(),
    };
    rows.push(gain);
    rows.push(bias);
}

/// Pads a dimension with zeros to whole vectors.
fn pad<const D: usize>(x: Tensor<D>, dimension: usize) -> Tensor<D> {
    let mut dims = x.dims();
    let missing = padded(dims[dimension]) - dims[dimension];
    if missing == 0 {
        return x;
    }
    dims[dimension] = missing;
    let zeros = Tensor::zeros(dims, &x.device());
    Tensor::cat(vec![x, zeros], dimension)
}

#[cfg(test)]
mod tests;
