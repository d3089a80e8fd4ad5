//! The nonlinearity of a feed-forward block: GELU, then dropout.
//!
//! Its input is the widest tensor of a layer. Burn's operations compute a scalar error function for each value, a mask as
//! large as the tensor and a product. The fused operation for the CPU makes one pass forward and one backward, and keeps
//! only its input.

use std::f32::consts::FRAC_1_SQRT_2;

use burn::tensor::Tensor;

use crate::optimization::dropout::Mask;

/// Computes the exact GELU of a tensor, by the error function, then dropout.
#[must_use]
pub(super) fn activate(x: Tensor<3>, mask: Option<Mask>) -> Tensor<3> {
    #[cfg(feature = "flex")]
    if crate::optimization::kernels::is_flex(&x) {
        use burn::backend::Dispatch;
        use fused::FusedActivation as _;
        return Tensor::from_dispatch(Dispatch::fused_activation(x.into_dispatch(), mask));
    }
    plain(x, mask)
}

/// Computes GELU by Burn's operations.
///
/// Burn's own GELU is not used: on all backends but `flex` its backward pass is the derivative of the approximation by
/// tanh, which is off by 1e-4.
fn gelu(x: Tensor<3>) -> Tensor<3> {
    (x.clone() * FRAC_1_SQRT_2).erf().add_scalar(1.0) * x * 0.5
}

/// Computes GELU and dropout by Burn's operations.
fn plain(x: Tensor<3>, mask: Option<Mask>) -> Tensor<3> {
    match mask {
        Some(mask) => mask.apply(gelu(x)),
        None => gelu(x),
    }
}

#[cfg(feature = "flex")]
mod fused {
    use burn::backend::autodiff::checkpoint::base::Checkpointer;
    use burn::backend::autodiff::checkpoint::strategy::CheckpointStrategy;
    use burn::backend::autodiff::grads::Gradients;
    use burn::backend::autodiff::ops::{Backward, Ops, OpsKind, unary};
    use burn::backend::flex::FlexTensor;
    use burn::backend::tensor::FloatTensor;
    use burn::backend::{Autodiff, Backend, Flex, TensorMetadata as _, backend_extension};
    use burn::tensor::TensorData;
    use pulp::{Arch, Simd, WithSimd};
    use rayon::prelude::*;

    use super::Mask;
    use crate::optimization::dropout::RowMask;
    use crate::optimization::kernels::exponential::exp_negative;

    /// GELU and dropout as one operation, `[b, tokens, width]`.
    #[backend_extension(Flex, Autodiff)]
    pub trait FusedActivation: Backend {
        /// Computes the operation; see [`activate`](super::activate).
        fn fused_activation(x: FloatTensor<Self>, mask: Option<Mask>) -> FloatTensor<Self>;
    }

    impl FusedActivation for Flex {
        fn fused_activation(x: FlexTensor, mask: Option<Mask>) -> FlexTensor {
            by_rows(&x.to_contiguous(), None, mask)
        }
    }

    impl<C: CheckpointStrategy> FusedActivation for Autodiff<Flex, C> {
        fn fused_activation(x: FloatTensor<Self>, mask: Option<Mask>) -> FloatTensor<Self> {
            let (x, node) = x.into_parts();
            let x = x.to_contiguous();
            let output = by_rows(&x, None, mask);
            match FusedBackward
                .prepare::<C>([node])
                .compute_bound()
                .stateful()
            {
                OpsKind::Tracked(operation) => operation.finish((x, mask), output),
                OpsKind::UnTracked(operation) => operation.finish(output),
            }
        }
    }

    #[derive(Debug)]
    struct FusedBackward;

    impl Backward<Flex, 1> for FusedBackward {
        type State = (FlexTensor, Option<Mask>);

        fn backward(
            self,
            ops: Ops<Self::State, 1>,
            gradients: &mut Gradients,
            _checkpointer: &mut Checkpointer,
        ) {
            let (x, mask) = ops.state;
            unary::<Flex, _>(ops.parents, ops.node, gradients, |gradient| {
                by_rows(&x, Some(&gradient.to_contiguous()), mask)
            });
        }
    }

    /// Computes the activation of `x`, or its gradient times the given one; all contiguous.
    fn by_rows(x: &FlexTensor, gradient: Option<&FlexTensor>, mask: Option<Mask>) -> FlexTensor {
        let dims = x.shape();
        let size = dims.num_elements();
        let width = dims[dims.num_dims() - 1].max(1);
        let values = |tensor: &FlexTensor| {
            let first = tensor.layout().start_offset();
            first..first + size
        };
        let mut output = x.storage::<f32>()[values(x)].to_vec();
        let gradient = gradient.map(|tensor| &tensor.storage::<f32>()[values(tensor)]);
        // Number of rows per task of a thread.
        let rows = 256;
        output
            .par_chunks_mut(rows * width)
            .enumerate()
            .for_each(|(chunk, output)| {
                Arch::new().dispatch(Chunk {
                    gradient: gradient.map(|g| &g[chunk * rows * width..][..output.len()]),
                    output,
                    width,
                    mask: mask.map(|mask| (mask, chunk * rows)),
                });
            });
        FlexTensor::from_data(TensorData::new(output, dims))
    }

    /// Rows of a tensor, and the index of the first one in the mask.
    struct Chunk<'a> {
        output: &'a mut [f32],
        gradient: Option<&'a [f32]>,
        width: usize,
        mask: Option<(Mask, usize)>,
    }

    impl WithSimd for Chunk<'_> {
        type Output = ();

        #[inline(always)]
        fn with_simd<S: Simd>(self, _simd: S) {
            for (row, output) in self.output.chunks_mut(self.width).enumerate() {
                match self.gradient {
                    None => output.iter_mut().for_each(|x| *x = gelu(*x)),
                    Some(gradient) => {
                        for (x, gradient) in output.iter_mut().zip(&gradient[row * self.width..]) {
                            *x = gelu_slope(*x) * gradient;
                        }
                    }
                }
                if let Some((mask, first)) = self.mask {
                    let mask: (RowMask, f32) = (mask.row(first + row), mask.scale);
                    mask.0.zero(output);
                    output.iter_mut().for_each(|x| *x *= mask.1);
                }
            }
        }
    }

    /// GELU: `x` times the normal distribution function of `x`.
    #[inline(always)]
    pub(super) fn gelu(x: f32) -> f32 {
        x * normal(x).0
    }

    /// Derivative of [`gelu`].
    #[inline(always)]
    pub(super) fn gelu_slope(x: f32) -> f32 {
        let (below, density) = normal(x);
        below + x * density
    }

    /// Distribution function and density of the standard normal distribution; absolute error below 3e-7.
    ///
    /// Abramowitz and Stegun, Handbook of Mathematical Functions, 7.1.26, in which the error
    /// function is a polynomial times the same exponential as the density.
    #[inline(always)]
    fn normal(x: f32) -> (f32, f32) {
        let size = x.abs();
        let bell = exp_negative(-0.5 * x * x);
        let t = 1.0 / (1.0 + 0.327_591_1 * std::f32::consts::FRAC_1_SQRT_2 * size);
        let series = t * (1.421_413_7 + t * (-1.453_152 + t * 1.061_405_4));
        let series = t * (0.254_829_6 + t * (-0.284_496_74 + series));
        let tail = 0.5 * series * bell;
        let below = if x < 0.0 { tail } else { 1.0 - tail };
        (below, bell * 0.398_942_3)
    }
}

#[cfg(all(test, feature = "flex"))]
mod tests {
    use super::*;
    use crate::optimization::dropout::Dropout;
    use crate::optimization::read_back;
    use burn::tensor::{Device, Distribution};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn the_fused_operation_gives_the_same_as_burns_operations() {
        let device = Device::flex().autodiff();
        // More rows than a thread takes at a time, and a width that is not a multiple of a vector.
        let dims = [2, 300, 37];
        let values = Tensor::random(dims, Distribution::Normal(0.0, 2.0), &device);
        let weights = Tensor::<3>::random(dims, Distribution::Default, &device);
        let mut dropout = Dropout::from(ChaCha8Rng::seed_from_u64(7));
        for mask in [None, dropout.mask(0.15)] {
            let run = |implementation: fn(Tensor<3>, Option<Mask>) -> Tensor<3>| {
                let x = Tensor::<3>::require_grad(values.clone());
                let output = implementation(x.clone(), mask);
                let gradients = (output.clone() * weights.clone()).sum().backward();
                let gradient = x.grad(&gradients).expect("a gradient of the input");
                [read_back(output.inner()), read_back(gradient)]
            };
            for (found, expected) in run(activate).iter().zip(run(plain)) {
                for (found, expected) in found.iter().zip(expected) {
                    assert!((found - expected).abs() < 2e-6, "{found}, not {expected}");
                }
            }
        }
    }

    #[test]
    fn far_from_zero_gelu_is_the_identity_or_zero() {
        for x in [20.0_f32, 1e4] {
            assert_eq!(fused::gelu(x), x);
            assert_eq!(fused::gelu_slope(x), 1.0);
            assert!(fused::gelu(-x).abs() < 1e-30 * x);
        }
    }
}
