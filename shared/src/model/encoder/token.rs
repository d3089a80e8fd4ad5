//! One patch on its way through the layers.

use super::{attention::Heads, linear::Codes};
use crate::model::kernels::Aligned;
use crate::units::{CHANNELS, PATCH};

/// The residual stream of a patch, and the memory that its way through the layers writes to. Nothing outlives the
/// patch.
///
/// Kept beside what is remembered, so that no step spends its time on clearing it.
#[derive(Clone, Debug)]
pub struct Token<const D: usize> {
    /// The residual stream.
    pub h: [f32; D],
    /// Codes of the patch's samples.
    pub samples: Aligned<[[i16; CHANNELS]; PATCH]>,
    /// The stream normalised, or what the heads attend to.
    pub normalised: [f32; D],
    /// Query, key and value; or the feed-forward's hidden values, twice the width.
    pub wide: [[f32; D]; 3],
    /// What a linear map reads.
    pub codes: Codes<D>,
    /// What one that adds to the residual stream has summed.
    pub sums: [i32; D],
    /// Of the attention heads.
    pub heads: Heads,
}

impl<const D: usize> Token<D> {
    /// All zeros.
    pub const EMPTY: Self = Self {
        h: [0.0; D],
        samples: Aligned([[0; CHANNELS]; PATCH]),
        normalised: [0.0; D],
        wide: [[0.0; D]; 3],
        codes: Aligned([[0; D]; 2]),
        sums: [0; D],
        heads: Heads::EMPTY,
    };
}
