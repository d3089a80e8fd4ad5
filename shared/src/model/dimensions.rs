//! The numbers that fix a model's tensor shapes, and their limits.

use crate::intent::Vocabulary;
use crate::kernels;
use crate::units::{CHANNELS, LOOK_BACK, PATCH, WINDOW_PATCHES};

/// Attention heads of every model.
pub(crate) const HEADS: usize = 4;
/// Largest width of the residual stream: 32 per head.
pub(crate) const MAX_WIDTH: usize = 128;
/// Smallest width of the residual stream.
pub(crate) const MIN_WIDTH: usize = 16;
/// Largest number of layers.
pub(crate) const MAX_LAYERS: usize = 3;
/// Longest attention span, in patches: the most terms that the attention kernels sum.
pub(crate) const MAX_SPAN: usize = kernels::MAX_TERMS;
/// Most cache slots of a model, layers x span: of three layers of the longest span that fits the window. Two have 56.
pub(crate) const MAX_SLOTS: usize = 3 * 19;

const _: () = assert!(patches_needed(3, 19) <= WINDOW_PATCHES);
const _: () =
    assert!(patches_needed(3, 20) > WINDOW_PATCHES && patches_needed(2, 29) > WINDOW_PATCHES);
// Longest rows of weights: the patch, and the second matrix of the feed-forward.
const _: () = assert!(PATCH * CHANNELS <= kernels::MAX_COLUMNS);
const _: () = assert!(2 * MAX_WIDTH <= kernels::MAX_COLUMNS);
const _: () = assert!(MAX_WIDTH / HEADS <= kernels::MAX_TERMS);

/// The numbers that fix every tensor's shape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dimensions {
    /// Width d of the residual stream: a multiple of 8, 16 to 128.
    pub width: usize,
    /// Number of layers L, 1 to 3.
    pub layers: usize,
    /// Patches that attention sees, the newest included, 1 to 32.
    pub span: usize,
    /// The classes.
    pub vocabulary: Vocabulary,
    /// Whether each row of the look-back head has one more output after the classes: movement outside
    /// the vocabulary.
    pub other: bool,
}

impl Dimensions {
    /// Dimensions of a model that has no output for movement outside the vocabulary.
    #[must_use]
    pub const fn new(vocabulary: Vocabulary, width: usize, layers: usize, span: usize) -> Self {
        Self {
            width,
            layers,
            span,
            vocabulary,
            other: false,
        }
    }

    /// Outputs of the look-back head for each row: the classes, and movement outside the vocabulary.
    #[must_use]
    pub const fn row_outputs(&self) -> usize {
        self.vocabulary.classes() + self.other as usize
    }
}

/// Mapping from a preprocessed sample, 0..=128, to the encoder's input, 0..=1.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Companding {
    /// `x / 128`.
    Linear,
    /// `sqrt(x / 128)`: finer steps for weak contractions.
    SquareRoot,
}

/// Patches that one patch's output depends on, itself included: `layers (span - 1) + 1`.
#[must_use]
pub(crate) const fn receptive_field(layers: usize, span: usize) -> usize {
    layers * (span - 1) + 1
}

/// Patches that the rows of one step depend on, those of the look-back included.
pub(crate) const fn patches_needed(layers: usize, span: usize) -> usize {
    receptive_field(layers, span) + LOOK_BACK - 1
}
