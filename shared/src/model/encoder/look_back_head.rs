//! From the residual stream to the logits of the six newest patches.

use super::{
    linear::{self, Mapped, identity, quantize},
    norm::layer_norm,
    token::Token,
};
use crate::intent::MAX_CLASSES;
use crate::kernels::TILE_ROWS;
use crate::model::LookBackLogits;
use crate::model::dimensions::Dimensions;
use crate::model::file::{LinearWeights, NormWeights};
use crate::units::LOOK_BACK;

/// `W_h norm(h) + b_h`: outputs `j classes .. (j + 1) classes` are row `j`.
#[inline]
#[must_use]
pub(super) fn logits<const T: usize, const WIDTH: usize>(
    norm: &NormWeights<'_>,
    head: &LinearWeights<'_>,
    dimensions: &Dimensions,
    tokens: &mut [Token<WIDTH>; T],
) -> [LookBackLogits; T] {
    let (width, classes) = (dimensions.width, dimensions.vocabulary.classes());
    let mut outputs = [[0.0; (LOOK_BACK * MAX_CLASSES).next_multiple_of(TILE_ROWS)]; T];
    let rows = (LOOK_BACK * classes).next_multiple_of(TILE_ROWS);
    let mut places = outputs.iter_mut();
    let tokens = tokens.each_mut().map(|token| {
        let normalised = &mut token.normalised[..width];
        layer_norm(norm, &token.residual[..width], normalised);
        Mapped {
            token: quantize(normalised, &mut token.codes),
            outputs: places.next().map_or(&mut [], |place| &mut place[..rows]),
        }
    });
    linear::map(head, tokens, identity);
    outputs.map(|outputs| {
        let mut logits = LookBackLogits::default();
        for (row, outputs) in logits.iter_mut().zip(outputs.chunks_exact(classes)) {
            row[..classes].copy_from_slice(outputs);
        }
        logits
    })
}
