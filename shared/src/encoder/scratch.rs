//! What a step writes on the way to its answer.

use super::{attention::Heads, linear::Codes};
use crate::kernels::Aligned;

/// Memory that a step uses and nothing remembers.
///
/// Kept beside what is remembered, so that no step spends its time on clearing it.
#[derive(Clone, Debug)]
pub struct Scratch<const D: usize> {
    /// A normalised token, or what the heads attend to.
    pub token: [f32; D],
    /// Query, key and value; or the feed-forward's hidden values, twice the width.
    pub wide: [[f32; D]; 3],
    /// What a linear map reads.
    pub codes: Codes<D>,
    /// What one that adds to the residual stream has summed.
    pub sums: [i32; D],
    /// Of the attention heads.
    pub heads: Heads,
}

impl<const D: usize> Scratch<D> {
    /// All zeros.
    pub const EMPTY: Self = Self {
        token: [0.0; D],
        wide: [[0.0; D]; 3],
        codes: Aligned([[0; D]; 2]),
        sums: [0; D],
        heads: Heads::EMPTY,
    };
}
