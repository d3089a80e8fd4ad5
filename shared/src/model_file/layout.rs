//! The tensors as they lie in the file: borrowed, at any alignment.

use crate::encoder::MAX_LAYERS;

/// Little-endian f32 numbers, read one at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Floats<'m>(pub(super) &'m [[u8; 4]]);

impl<'m> Floats<'m> {
    /// The numbers in order.
    pub fn iter(self) -> impl ExactSizeIterator<Item = f32> + use<'m> {
        self.0.iter().map(|&bytes| f32::from_le_bytes(bytes))
    }

    /// How many numbers.
    #[must_use]
    pub const fn len(self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0.is_empty()
    }

    /// The numbers of row `row` of a matrix with that many columns; none beyond its end.
    #[must_use]
    pub fn row(self, row: usize, columns: usize) -> Self {
        Self(
            self.0
                .get(row * columns..(row + 1) * columns)
                .unwrap_or_default(),
        )
    }
}

/// A linear map: `y[r] = scales[r] * sum over c of weights[r][c] x[c] + bias[r]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct LinearWeights<'m> {
    /// Row-major `[outputs][inputs]`, each -127..=127.
    pub weights: &'m [i8],
    /// One per output.
    pub scales: Floats<'m>,
    /// One per output.
    pub bias: Floats<'m>,
}

/// A layer norm's learned part, `[d]` each.
#[derive(Clone, Copy, Debug, Default)]
pub struct NormWeights<'m> {
    /// Factor after normalising.
    pub gain: Floats<'m>,
    /// Term after the gain.
    pub bias: Floats<'m>,
}

/// One pre-norm layer.
#[derive(Clone, Copy, Debug, Default)]
pub struct LayerWeights<'m> {
    /// Before attention.
    pub norm1: NormWeights<'m>,
    /// d -> 3d: query, key, value.
    pub qkv: LinearWeights<'m>,
    /// `[heads][span]`: what is added to the score of the patch that many patches back.
    pub relative_bias: Floats<'m>,
    /// d -> d: after attention.
    pub out: LinearWeights<'m>,
    /// Before the feed-forward.
    pub norm2: NormWeights<'m>,
    /// d -> 2d.
    pub ff1: LinearWeights<'m>,
    /// 2d -> d.
    pub ff2: LinearWeights<'m>,
}

/// All tensors of a model.
#[derive(Clone, Copy, Debug, Default)]
pub struct Weights<'m> {
    /// 80 -> d: the patch, sample by sample.
    pub embed: LinearWeights<'m>,
    /// The layers; those from the model's own number on are empty.
    pub layers: [LayerWeights<'m>; MAX_LAYERS],
    /// Before the head.
    pub final_norm: NormWeights<'m>,
    /// d -> 6 x classes: the newest patch's classes first.
    pub head: LinearWeights<'m>,
}
