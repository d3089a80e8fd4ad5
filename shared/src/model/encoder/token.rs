//! Scratch memory for the computation of one patch, and its layer norm.

use crate::arithmetic::inverse_square_root;
use crate::kernels::Aligned;
use crate::model::dimensions::MAX_SPAN;
use crate::model::file::NormWeights;
use crate::units::{CHANNELS, PATCH};

/// The residual stream of a patch and the scratch memory of its computation. Nothing is kept from
/// patch to patch.
///
/// It is part of the state, so that no step has to clear it. A model narrower than `WIDTH` uses
/// the first elements of every array.
#[derive(Clone, Debug)]
pub(super) struct Token<const WIDTH: usize> {
    /// The residual stream h.
    pub residual: [f32; WIDTH],
    /// Codes of the patch's samples.
    pub samples: Aligned<[[i16; CHANNELS]; PATCH]>,
    /// The normalised residual stream, then the output of the attention heads.
    pub normalised: [f32; WIDTH],
    /// Query, key and value one after another; or the feed-forward's hidden values.
    pub wide: [[f32; WIDTH]; 3],
    /// Codes of the input of a linear map.
    pub codes: Codes<WIDTH>,
    /// Integer sums of a linear map that adds to the residual stream.
    pub sums: [i32; WIDTH],
    /// Scratch memory of the attention heads, one after another.
    pub head: HeadScratch,
}

impl<const WIDTH: usize> Token<WIDTH> {
    /// All zeros.
    pub const EMPTY: Self = Self {
        residual: [0.0; WIDTH],
        samples: Aligned([[0; CHANNELS]; PATCH]),
        normalised: [0.0; WIDTH],
        wide: [[0.0; WIDTH]; 3],
        codes: Aligned([[0; WIDTH]; 2]),
        sums: [0; WIDTH],
        head: HeadScratch::EMPTY,
    };
}

/// Codes of the input of a linear map: the width, or twice the width.
pub(super) type Codes<const WIDTH: usize> = Aligned<[[i16; WIDTH]; 2]>;

/// Scratch memory of one attention head.
#[derive(Clone, Debug)]
pub(super) struct HeadScratch {
    /// The query's codes, then the attention weights' codes.
    pub codes: Aligned<[i16; MAX_SPAN]>,
    /// Products with the keys by slot, then sums over the values by channel of the head.
    pub sums: [i32; MAX_SPAN],
    /// Scores of the slots, then their unnormalised weights.
    pub weights: [f32; MAX_SPAN],
    /// Weights of the slots times the scales of their values.
    pub scaled: [f32; MAX_SPAN],
}

impl HeadScratch {
    /// All zeros.
    pub const EMPTY: Self = Self {
        codes: Aligned([0; MAX_SPAN]),
        sums: [0; MAX_SPAN],
        weights: [0.0; MAX_SPAN],
        scaled: [0.0; MAX_SPAN],
    };
}

/// Added to the variance, as in training.
const EPSILON: f32 = 1e-5;

/// Layer norm: `normalised = ((h - mean) / sqrt(variance + 1e-5)) * gain + bias`, the variance over all of `h`.
///
/// Sums run from the first value to the last.
#[inline]
pub(super) fn layer_norm(norm: &NormWeights<'_>, h: &[f32], normalised: &mut [f32]) {
    let share = 1.0 / h.len() as f32;
    let mut mean = 0.0;
    for value in h {
        mean += value;
    }
    mean *= share;
    let mut variance = 0.0;
    for (centred, value) in normalised.iter_mut().zip(h) {
        let difference = value - mean;
        *centred = difference;
        variance += difference * difference;
    }
    let inverse = inverse_square_root(variance * share + EPSILON);
    let constants = norm.gain.iter().zip(norm.bias.iter());
    for (value, (gain, bias)) in normalised.iter_mut().zip(constants) {
        *value = *value * inverse * gain + bias;
    }
}
