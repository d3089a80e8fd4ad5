//! Look-back head in memory of its own, with its weights in the form of a model file.

use super::dimensions::Dimensions;
use super::file::{LinearWeights, Model, holds};
use crate::intent::MAX_LOGITS;
use crate::kernels::{Aligned, TILE_ROWS, code_limit, row};
use crate::units::LOOK_BACK;

/// Largest width of a model whose head can be replaced: the largest of a device.
pub const MAX_HEAD_WIDTH: usize = 64;
/// Most outputs of a head.
pub(crate) const MAX_OUTPUTS: usize = LOOK_BACK * MAX_LOGITS;
const TILED: usize = MAX_OUTPUTS.next_multiple_of(TILE_ROWS);

/// Look-back head that an [`Encoder`](super::encoder::Encoder) runs with in place of its model's.
#[derive(Clone, Debug)]
pub struct Head {
    /// Columns of the weights: the model's width.
    pub(crate) width: usize,
    /// Outputs: the look-back rows times the [row's outputs](Dimensions::row_outputs).
    pub(crate) outputs: usize,
    /// Tiles of `outputs` rows.
    pub(crate) weights: Aligned<[[i8; MAX_HEAD_WIDTH]; TILED]>,
    pub(crate) scales: [f32; MAX_OUTPUTS],
    pub(crate) bias: [f32; MAX_OUTPUTS],
    pub(crate) code_limit: i16,
}

impl Head {
    /// A head without outputs, for no model.
    pub const EMPTY: Self = Self {
        width: 0,
        outputs: 0,
        weights: Aligned([[0; MAX_HEAD_WIDTH]; TILED]),
        scales: [0.0; MAX_OUTPUTS],
        bias: [0.0; MAX_OUTPUTS],
        // All bytes zero: a static one takes no flash.
        code_limit: 0,
    };

    /// Copy of a model's head; `None` if the model is wider than [`MAX_HEAD_WIDTH`].
    #[must_use]
    pub fn of(model: &Model<'_>) -> Option<Self> {
        let mut head = Self::EMPTY;
        let fits = head.copy(&model.header.dimensions, &model.weights.head);
        fits.then_some(head)
    }

    /// Copies a head for models of these dimensions, in place: a device's stack has no room for a second one. Returns whether
    /// they are narrow enough; if not, nothing changes.
    pub(crate) fn copy(&mut self, dimensions: &Dimensions, own: &LinearWeights<'_>) -> bool {
        if dimensions.width > MAX_HEAD_WIDTH {
            return false;
        }
        self.width = dimensions.width;
        self.outputs = LOOK_BACK * dimensions.row_outputs();
        self.tiles_mut().copy_from_slice(own.weights);
        self.scales[..own.scales.len()].copy_from_slice(own.scales);
        self.bias[..own.bias.len()].copy_from_slice(own.bias);
        self.code_limit = own.code_limit;
        true
    }

    /// Whether the head is one for models of these dimensions.
    #[must_use]
    pub fn fits(&self, dimensions: &Dimensions) -> bool {
        (self.width, self.outputs) == (dimensions.width, LOOK_BACK * dimensions.row_outputs())
    }

    /// Quantizes the weights of an output.
    pub(crate) fn put(&mut self, output: usize, weights: &[f32], bias: f32) {
        let mut bytes = [0; MAX_HEAD_WIDTH];
        let bytes = &mut bytes[..weights.len()];
        self.scales[output] = row::quantize(weights, bytes);
        self.bias[output] = bias;
        row::put(self.tiles_mut(), output, bytes);
    }

    /// Completes a head whose outputs are all put. Returns whether a model file may hold every number.
    pub(crate) fn complete(&mut self) -> bool {
        self.code_limit = code_limit(self.tiles(), self.width);
        are_allowed(&self.scales[..self.outputs], &self.bias[..self.outputs])
    }

    pub(crate) fn tiles(&self) -> &[i8] {
        let bytes = self.outputs.next_multiple_of(TILE_ROWS) * self.width;
        &self.weights.0.as_flattened()[..bytes]
    }

    pub(crate) fn tiles_mut(&mut self) -> &mut [i8] {
        let bytes = self.outputs.next_multiple_of(TILE_ROWS) * self.width;
        &mut self.weights.0.as_flattened_mut()[..bytes]
    }

    /// The tensors, as an encoder reads them.
    pub(crate) fn linear(&self) -> LinearWeights<'_> {
        LinearWeights {
            weights: self.tiles(),
            code_limit: self.code_limit,
            scales: &self.scales[..self.outputs],
            bias: &self.bias[..self.outputs],
        }
    }
}

/// Whether a model file may hold a head with these numbers.
pub(crate) fn are_allowed(scales: &[f32], bias: &[f32]) -> bool {
    holds(scales) && scales.iter().all(|scale| *scale >= 0.0) && holds(bias)
}

/// Compares shapes and tensors; the unused memory behind them does not count.
impl PartialEq for Head {
    fn eq(&self, other: &Self) -> bool {
        let of = |head: &Self| (head.width, head.outputs, head.code_limit);
        let [own, others] = [self.linear(), other.linear()];
        of(self) == of(other)
            && (own.weights, own.scales, own.bias) == (others.weights, others.scales, others.bias)
    }
}
