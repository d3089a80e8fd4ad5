//! Attention as one operation of the CPU backend, windows in parallel on all threads.
//!
//! The order of a window's sums is fixed, so the result does not depend on the number of threads.

use burn::backend::autodiff::checkpoint::base::Checkpointer;
use burn::backend::autodiff::checkpoint::strategy::CheckpointStrategy;
use burn::backend::autodiff::grads::Gradients;
use burn::backend::autodiff::ops::{self, Ops, OpsKind, unary};
use burn::backend::flex::FlexTensor;
use burn::backend::tensor::FloatTensor;
use burn::backend::{Autodiff, Backend, Flex, TensorMetadata as _, backend_extension};
use burn::tensor::TensorData;
use pulp::Arch;
use rayon::prelude::*;

use super::window::{Backward, Forward, Window};
use crate::optimization::dropout::Mask;
use crate::optimization::kernels::softmax::RowStatistics;

/// Parameters of attention.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Number of heads.
    pub heads: usize,
    /// Whether the second half of a window's tokens is blocked, for each window; empty if no window's is.
    pub blocked: Vec<bool>,
    /// Dropout of the attention weights.
    pub mask: Option<Mask>,
}

/// Attention as one operation, from `[b, tokens, 3 d]` (queries, keys, values) to `[b, tokens, d]`.
#[backend_extension(Flex, Autodiff)]
pub trait FusedAttention: Backend {
    /// Computes attention. Heads are contiguous parts of `d`; see [`Settings`].
    fn fused_attention(qkv: FloatTensor<Self>, settings: Settings) -> FloatTensor<Self>;
}

impl FusedAttention for Flex {
    fn fused_attention(qkv: FlexTensor, settings: Settings) -> FlexTensor {
        Pass::new(&qkv, settings).forward().0
    }
}

impl<C: CheckpointStrategy> FusedAttention for Autodiff<Flex, C> {
    fn fused_attention(qkv: FloatTensor<Self>, settings: Settings) -> FloatTensor<Self> {
        let (qkv, node) = qkv.into_parts();
        let pass = Pass::new(&qkv, settings);
        let (output, statistics) = pass.forward();
        let operation = ops::Backward::prepare::<C>(FusedBackward, [node]);
        match operation.compute_bound().stateful() {
            OpsKind::Tracked(operation) => operation.finish((pass, statistics), output),
            OpsKind::UnTracked(operation) => operation.finish(output),
        }
    }
}

#[derive(Debug)]
struct FusedBackward;

impl ops::Backward<Flex, 1> for FusedBackward {
    /// State for the backward pass: the batch and its softmax statistics.
    type State = (Pass, Vec<RowStatistics>);

    fn backward(
        self,
        ops: Ops<Self::State, 1>,
        gradients: &mut Gradients,
        _checkpointer: &mut Checkpointer,
    ) {
        let (pass, statistics) = ops.state;
        unary::<Flex, _>(ops.parents, ops.node, gradients, |gradient| {
            pass.backward(&gradient.to_contiguous(), &statistics)
        });
    }
}

/// Batch of queries, keys and values.
#[derive(Clone, Debug)]
struct Pass {
    /// Queries, keys and values in a contiguous tensor.
    qkv: FlexTensor,
    settings: Settings,
    windows: usize,
    tokens: usize,
    d: usize,
}

impl Pass {
    fn new(qkv: &FlexTensor, settings: Settings) -> Self {
        let qkv = qkv.to_contiguous();
        let dims = qkv.shape();
        Self {
            qkv,
            settings,
            windows: dims[0],
            tokens: dims[1],
            d: dims[2] / 3,
        }
    }

    fn window(&self, window: usize) -> Window<'_> {
        let blocked = self.settings.blocked.get(window) == Some(&true);
        let values = self.tokens * 3 * self.d;
        let rows = self.settings.heads * self.tokens;
        Window {
            qkv: part(&self.qkv, window, values),
            attending: if blocked {
                self.tokens / 2
            } else {
                self.tokens
            },
            tokens: self.tokens,
            d: self.d,
            heads: self.settings.heads,
            mask: self.settings.mask.map(|mask| (mask, window * rows)),
        }
    }

    /// Number of values of a window's output, and number of its queries over all heads.
    fn sizes(&self) -> (usize, usize) {
        (self.tokens * self.d, self.settings.heads * self.tokens)
    }

    /// Computes attention, `[b, tokens, d]`, and its softmax statistics, `[b, heads, tokens]`.
    fn forward(&self) -> (FlexTensor, Vec<RowStatistics>) {
        let (values, queries) = self.sizes();
        let mut output = vec![0.0_f32; self.windows * values];
        let mut statistics = vec![RowStatistics::default(); self.windows * queries];
        output
            .par_chunks_mut(values.max(1))
            .zip(statistics.par_chunks_mut(queries.max(1)))
            .enumerate()
            .for_each(|(window, (output, statistics))| {
                Arch::new().dispatch(Forward {
                    window: self.window(window),
                    output,
                    statistics,
                });
            });
        let dims = [self.windows, self.tokens, self.d];
        let output = FlexTensor::from_data(TensorData::new(output, dims));
        (output, statistics)
    }

    /// Computes the gradients of queries, keys and values, `[b, tokens, 3 d]`; all tensors are contiguous.
    fn backward(&self, gradient: &FlexTensor, statistics: &[RowStatistics]) -> FlexTensor {
        let (values, queries) = self.sizes();
        let mut gradients = vec![0.0_f32; 3 * self.windows * values];
        gradients
            .par_chunks_mut((3 * values).max(1))
            .enumerate()
            .for_each(|(window, gradients)| {
                Arch::new().dispatch(Backward {
                    window: self.window(window),
                    statistics: &statistics[window * queries..][..queries],
                    gradient: part(gradient, window, values),
                    gradients,
                });
            });
        let dims = [self.windows, self.tokens, 3 * self.d];
        FlexTensor::from_data(TensorData::new(gradients, dims))
    }
}

/// Slice of a contiguous tensor: the `size` values of a window.
fn part(of: &FlexTensor, window: usize, size: usize) -> &[f32] {
    &of.storage()[of.layout().start_offset() + window * size..][..size]
}
