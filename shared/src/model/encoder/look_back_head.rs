//! From the residual stream to the scores of the six newest patches.

use super::{
    Logits,
    linear::{self, Mapped, as_is, quantize},
    norm::normalise,
    token::Token,
};
use crate::intent::MAX_CLASSES;
use crate::model::file::{LinearWeights, NormWeights};
use crate::model::kernels::TILE_ROWS;
use crate::units::LOOK_BACK;

/// `W_h norm(h) + b_h`: outputs `j classes .. (j + 1) classes` are row `j`.
#[inline]
#[must_use]
pub fn scores<const T: usize, const D: usize>(
    norm: &NormWeights<'_>,
    head: &LinearWeights<'_>,
    tokens: &mut [Token<D>; T],
    classes: usize,
) -> [Logits; T] {
    let mut outputs = [[0.0; (LOOK_BACK * MAX_CLASSES).next_multiple_of(TILE_ROWS)]; T];
    let rows = (LOOK_BACK * classes).next_multiple_of(TILE_ROWS);
    let mut places = outputs.iter_mut();
    let tokens = tokens.each_mut().map(|token| {
        normalise(norm, &token.h, &mut token.normalised);
        Mapped {
            token: quantize(&token.normalised, &mut token.codes),
            outputs: places.next().map_or(&mut [], |place| &mut place[..rows]),
        }
    });
    linear::map(head, tokens, as_is);
    outputs.map(|outputs| {
        let mut logits = Logits::default();
        for (row, outputs) in logits.iter_mut().zip(outputs.chunks_exact(classes)) {
            row[..classes].copy_from_slice(outputs);
        }
        logits
    })
}
