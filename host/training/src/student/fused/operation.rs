//! Fused operation and its backward pass, groups of sequences in parallel.

use burn::backend::autodiff::checkpoint::base::Checkpointer;
use burn::backend::autodiff::checkpoint::strategy::CheckpointStrategy;
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{self, Ops, OpsKind, unary};
use burn::backend::flex::FlexTensor;
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Flex, TensorMetadata as _, backend_extension};
use burn::tensor::TensorData;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::parameters::{Parameters, Sizes, Transposes};
use super::sequence::{Saved, Scratch};

/// Number of sequences whose gradients are summed one after the other; the sums of the groups are then added in order.
const GROUP: usize = 8;

/// The student as one operation: EMG, `[b, patches, inputs]`, and all parameters to logits,
/// `[b, patches, outputs]`.
#[backend_extension(Flex, Autodiff)]
pub trait FusedStudent: Backend {
    /// Computes the logits; see [`Sizes`] for the parameters. EMG gets no gradient.
    fn fused_student(
        emg: FloatTensor<Self>,
        parameters: FloatTensor<Self>,
        sizes: Sizes,
    ) -> FloatTensor<Self>;
}

impl FusedStudent for Flex {
    fn fused_student(emg: FlexTensor, parameters: FlexTensor, sizes: Sizes) -> FlexTensor {
        Pass::new(&emg, &parameters, sizes).forward(false).0
    }
}

impl<C: CheckpointStrategy> FusedStudent for Autodiff<Flex, C> {
    fn fused_student(
        emg: FloatTensor<Self>,
        parameters: FloatTensor<Self>,
        sizes: Sizes,
    ) -> FloatTensor<Self> {
        let (emg, _) = emg.into_parts();
        let (parameters, node) = parameters.into_parts();
        let pass = Pass::new(&emg, &parameters, sizes);
        let operation = ops::Backward::prepare::<C>(FusedBackward, [node]);
        match operation.compute_bound().stateful() {
            OpsKind::Tracked(operation) => {
                let (output, saved) = pass.forward(true);
                operation.finish((pass, saved), output)
            }
            OpsKind::UnTracked(operation) => operation.finish(pass.forward(false).0),
        }
    }
}

#[derive(Debug)]
struct FusedBackward;

impl ops::Backward<Flex, 1> for FusedBackward {
    type State = (Pass, Vec<Saved>);

    fn backward(
        self,
        ops: Ops<Self::State, 1>,
        gradients: &mut Gradients,
        _checkpointer: &mut Checkpointer,
    ) {
        let (pass, saved) = ops.state;
        unary::<Flex, _>(ops.parents, ops.node, gradients, |gradient| {
            pass.backward(&gradient.to_contiguous(), &saved)
        });
    }
}

/// One batch and the parameters, in contiguous tensors.
#[derive(Clone, Debug)]
struct Pass {
    emg: FlexTensor,
    parameters: FlexTensor,
    sizes: Sizes,
    batch: usize,
    patches: usize,
}

impl Pass {
    fn new(emg: &FlexTensor, parameters: &FlexTensor, sizes: Sizes) -> Self {
        let emg = emg.to_contiguous();
        let dims = emg.shape();
        Self {
            emg,
            parameters: parameters.to_contiguous(),
            sizes,
            batch: dims[0],
            patches: dims[1],
        }
    }

    fn parameters(&self) -> &[f32] {
        values(&self.parameters, 0, self.sizes.parameters())
    }

    fn emg(&self, sequence: usize) -> &[f32] {
        values(&self.emg, sequence, self.patches * self.sizes.inputs)
    }

    /// Computes the logits; with `save` also returns the values for the backward pass.
    fn forward(&self, save: bool) -> (FlexTensor, Vec<Saved>) {
        let parameters = Parameters::parts_of(self.parameters(), self.sizes);
        let size = self.patches * self.sizes.outputs;
        let mut output = vec![0.0_f32; self.batch * size];
        let saved = output
            .par_chunks_mut((GROUP * size).max(1))
            .enumerate()
            .flat_map_iter(|(group, output)| {
                Arch::new().dispatch(Forward {
                    pass: self,
                    parameters: &parameters,
                    first: group * GROUP,
                    output,
                    save,
                })
            })
            .collect();
        let dims = [self.batch, self.patches, self.sizes.outputs];
        (FlexTensor::from_data(TensorData::new(output, dims)), saved)
    }

    /// Computes the gradients of all parameters.
    fn backward(&self, gradient: &FlexTensor, saved: &[Saved]) -> FlexTensor {
        let parameters = Parameters::parts_of(self.parameters(), self.sizes);
        let transposes = Transposes::of(&parameters);
        let groups: Vec<Vec<f32>> = saved
            .par_chunks(GROUP)
            .enumerate()
            .map(|(group, saved)| {
                Arch::new().dispatch(Backward {
                    pass: self,
                    parameters: &parameters,
                    transposes: &transposes,
                    first: group * GROUP,
                    gradient,
                    saved,
                })
            })
            .collect();
        let mut sum = vec![0.0; self.sizes.parameters()];
        for group in groups {
            for (sum, gradient) in sum.iter_mut().zip(group) {
                *sum += gradient;
            }
        }
        let dims = [sum.len()];
        FlexTensor::from_data(TensorData::new(sum, dims))
    }
}

/// The forward pass of a group of sequences.
struct Forward<'a> {
    pass: &'a Pass,
    parameters: &'a Parameters<&'a [f32]>,
    /// Index of the first sequence.
    first: usize,
    output: &'a mut [f32],
    save: bool,
}

impl WithSimd for Forward<'_> {
    type Output = Vec<Saved>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<Saved> {
        let Pass { sizes, patches, .. } = *self.pass;
        let mut scratch = Scratch::new(sizes, patches);
        let mut all = Vec::new();
        let mut saved = Saved::new(sizes, patches);
        let outputs = self.output.chunks_exact_mut(patches * sizes.outputs);
        for (sequence, output) in outputs.enumerate() {
            let emg = self.pass.emg(self.first + sequence);
            scratch.forward(simd, self.parameters, emg, &mut saved, output);
            if self.save {
                all.push(saved);
                saved = Saved::new(sizes, patches);
            }
        }
        all
    }
}

/// The backward pass of a group of sequences.
struct Backward<'a> {
    pass: &'a Pass,
    parameters: &'a Parameters<&'a [f32]>,
    transposes: &'a Transposes,
    /// Index of the first sequence.
    first: usize,
    /// Gradient of all logits of the batch.
    gradient: &'a FlexTensor,
    saved: &'a [Saved],
}

impl WithSimd for Backward<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f32> {
        let Pass { sizes, patches, .. } = *self.pass;
        let mut sums = vec![0.0; sizes.parameters()];
        let mut gradients = Parameters::parts_of(sums.as_mut_slice(), sizes);
        let mut scratch = Scratch::new(sizes, patches);
        for (sequence, saved) in self.saved.iter().enumerate() {
            let sequence = self.first + sequence;
            let logits = values(self.gradient, sequence, patches * sizes.outputs);
            let parameters = (self.parameters, self.transposes);
            let emg = self.pass.emg(sequence);
            scratch.backward(simd, parameters, (emg, logits), saved, &mut gradients);
        }
        sums
    }
}

/// Slice of a contiguous tensor: part `part` of `size` values.
fn values(of: &FlexTensor, part: usize, size: usize) -> &[f32] {
    &of.storage()[of.layout().start_offset() + part * size..][..size]
}
