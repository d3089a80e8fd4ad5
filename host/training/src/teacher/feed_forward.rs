//! The nonlinearity of a feed-forward block: GELU, then dropout.

use std::f32::consts::FRAC_1_SQRT_2;

use burn::tensor::Tensor;

use crate::optimization::dropout::Mask;

/// Computes the exact GELU of a tensor, by the error function, then dropout.
///
/// Burn's own GELU is not used: on all backends but `flex` its backward pass is the derivative of the approximation by
/// tanh, which is off by 1e-4.
pub(super) fn activate(x: Tensor<3>, mask: Option<Mask>) -> Tensor<3> {
    let gelu = (x.clone() * FRAC_1_SQRT_2).erf().add_scalar(1.0) * x * 0.5;
    match mask {
        Some(mask) => mask.apply(gelu),
        None => gelu,
    }
}
