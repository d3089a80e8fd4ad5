//! Look-back head: the logits of the six newest patches from the residual stream.

use super::{
    linear::{self, Mapped, quantize},
    token::{Token, layer_norm},
};
use crate::intent::MAX_LOGITS;
use crate::kernels::TILE_ROWS;
use crate::model::LookBackLogits;
use crate::model::dimensions::Dimensions;
use crate::model::file::{LinearWeights, NormWeights};
use crate::units::LOOK_BACK;

/// `W_h norm(h) + b_h`: outputs `j n .. (j + 1) n` are row `j`, `n` being the [row's outputs](Dimensions::row_outputs).
#[inline]
#[must_use]
pub(super) fn logits<const T: usize, const WIDTH: usize>(
    norm: &NormWeights<'_>,
    head: &LinearWeights<'_>,
    dimensions: &Dimensions,
    tokens: &mut [Token<WIDTH>; T],
) -> [LookBackLogits; T] {
    let (width, row_outputs) = (dimensions.width, dimensions.row_outputs());
    let mut outputs = [[0.0; (LOOK_BACK * MAX_LOGITS).next_multiple_of(TILE_ROWS)]; T];
    let rows = (LOOK_BACK * row_outputs).next_multiple_of(TILE_ROWS);
    let mut places = outputs.iter_mut();
    let tokens = tokens.each_mut().map(|token| {
        let normalised = &mut token.normalised[..width];
        layer_norm(norm, &token.residual[..width], normalised);
        Mapped {
            token: quantize(head, normalised, &mut token.codes),
            outputs: places.next().map_or(&mut [], |place| &mut place[..rows]),
        }
    });
    linear::map(head, tokens);
    outputs.map(|outputs| {
        let mut logits = LookBackLogits::default();
        for (row, outputs) in logits.iter_mut().zip(outputs.chunks_exact(row_outputs)) {
            row[..row_outputs].copy_from_slice(outputs);
        }
        logits
    })
}
