//! Why a model is refused: one cause per variant.

use super::decimal::Decimal;
use super::names::{Excerpt, TensorName};
use super::{ALIGNMENT, FORMAT_VERSION, LARGEST, MAGIC};
use crate::model::dimensions::{MAX_WIDTH, MIN_WIDTH};
use crate::stream::alignment::TemplateError;
use crate::units::{LOOK_BACK, MAX_ENTRY_MARGIN, WINDOW_PATCHES};

/// Why bytes are not a model for this program.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The address in memory is not a multiple of four.
    #[error(
        "starts {found} bytes after a multiple of {ALIGNMENT} in memory: copy it to an aligned buffer"
    )]
    Misaligned {
        /// Bytes beyond the multiple.
        found: usize,
    },
    /// Shorter than prefix and checksum.
    #[error("{found} bytes, a model has at least {expected}: write the file again")]
    TooShort {
        /// Fewest bytes of any model.
        expected: usize,
        /// Bytes given.
        found: usize,
    },
    /// Another file, or an erased region.
    #[error("starts with {found:02x?}, a model with {MAGIC:02x?}: give an .intent file")]
    Magic {
        /// The first bytes.
        found: [u8; 8],
    },
    /// Another format version.
    #[error("model format {found}, this build reads {FORMAT_VERSION}: export the model again")]
    Version {
        /// The file's format version.
        found: u8,
    },
    /// The declared length does not fit the region.
    #[error("declares {declared} bytes, {available} are available: copy the whole file again")]
    Length {
        /// Length in the file.
        declared: usize,
        /// Bytes given.
        available: usize,
    },
    /// A byte has changed.
    #[error("checksum {found:08x}, computed {expected:08x}: copy the file again")]
    Checksum {
        /// CRC-32 of the bytes.
        expected: u32,
        /// CRC-32 in the file.
        found: u32,
    },
    /// The header ends early or has a malformed number, text or list.
    #[error("malformed header field `{field}`: export the model again")]
    Header {
        /// The malformed field.
        field: &'static str,
    },
    /// Unsupported width of the residual stream.
    #[error(
        "width {found}, expected a multiple of 8, {MIN_WIDTH} to {MAX_WIDTH}: train a supported width"
    )]
    Width {
        /// The file's width.
        found: usize,
    },
    /// A number of the header out of its range.
    #[error("{what} {found}, expected {least} to {most}: train or export it for this program")]
    OutOfRange {
        /// Name of the number.
        what: &'static str,
        /// The file's number.
        found: usize,
        /// Smallest number that is supported.
        least: usize,
        /// Largest number that is supported.
        most: usize,
    },
    /// The logits would depend on more patches than the window has.
    #[error(
        "the newest {LOOK_BACK} patches depend on {found} patches, the window has \
         {WINDOW_PATCHES}: shorten the span or drop a layer"
    )]
    ReceptiveField {
        /// Patches that the look-back outputs depend on.
        found: usize,
    },
    /// Unsupported number of classes.
    #[error("{found} classes, expected 3, 5 or 6: train one of the three vocabularies")]
    Classes {
        /// The file's classes.
        found: usize,
    },
    /// Number of class names.
    #[error("{found} class names for {expected} classes: export the model again")]
    ClassCount {
        /// Classes.
        expected: usize,
        /// Names.
        found: usize,
    },
    /// A class name that is not the vocabulary's.
    #[error(
        "class {class} is named `{found}`, expected `{expected}`: train the vocabulary's order"
    )]
    ClassName {
        /// Class number.
        class: usize,
        /// The vocabulary's name.
        expected: &'static str,
        /// The file's name.
        found: Excerpt,
    },
    /// Unsupported width of the median.
    #[error("median of {found} samples, expected 3, or 1 for none: train with either")]
    MedianWidth {
        /// The file's width.
        found: u8,
    },
    /// The alignment template is damaged.
    #[error("alignment template: {0}")]
    Template(#[from] TemplateError),
    /// An entry margin out of range.
    #[error("entry margin {}, expected 0 to {}: export with one", Decimal(.found), Decimal(&MAX_ENTRY_MARGIN))]
    EntryMargin {
        /// The file's margin.
        found: f32,
    },
    /// A margin of early labels out of range.
    #[error("margin of early labels {}, expected 0 to {}: export with one", Decimal(.found), Decimal(&MAX_ENTRY_MARGIN))]
    EarlyMargin {
        /// The file's margin.
        found: f32,
    },
    /// A margin over movement outside the vocabulary out of range.
    #[error(
        "margin over other movement {}, expected -{} to {}: export with one",
        Decimal(.found), Decimal(&MAX_ENTRY_MARGIN), Decimal(&MAX_ENTRY_MARGIN)
    )]
    OtherMargin {
        /// The file's margin.
        found: f32,
    },
    /// A margin over movement outside the vocabulary for a model without such an output.
    #[error(
        "this model does not know movement outside the vocabulary: it has no margin over it; train one with data.other_movement = \"class\""
    )]
    NoOther,
    /// A head for a model of other dimensions.
    #[error(
        "the head is one for a model of other dimensions: take the model that it was learnt with"
    )]
    OtherHead,
    /// A metric that is infinite or NaN.
    #[error("a metric is {}, expected a finite number: evaluate and export the model again", Decimal(.found))]
    Metric {
        /// The value.
        found: f32,
    },
    /// A tensor's length does not match the dimensions.
    #[error("{tensor} has {found} bytes, expected {expected}: export the model again")]
    WeightLength {
        /// Tensor that is meant.
        tensor: TensorName,
        /// Bytes by the dimensions.
        expected: usize,
        /// Bytes in the file.
        found: usize,
    },
    /// The weights end before this tensor does.
    #[error("the file ends within {tensor}: export the model again")]
    WeightsEnd {
        /// Tensor that is meant.
        tensor: TensorName,
    },
    /// A negative scale.
    #[error("{tensor} holds {} at {index}, expected 0 or more: quantize the model again", Decimal(.found))]
    Scale {
        /// Tensor that is meant.
        tensor: TensorName,
        /// Position in it.
        index: usize,
        /// The number.
        found: f32,
    },
    /// A scale of zero, which silences a row of weights.
    #[error(
        "{tensor} holds 0 at {index}, where the row has weights; expected more than 0: quantize the model again"
    )]
    ZeroScale {
        /// Tensor that is meant.
        tensor: TensorName,
        /// Position in it: the row.
        index: usize,
    },
    /// Infinity, NaN, or a number so large that a sum could overflow.
    #[error(
        "{tensor} holds {} at {index}, expected a number from -{} to {}: train the model again",
        Decimal(.found), Decimal(&LARGEST), Decimal(&LARGEST)
    )]
    Number {
        /// Tensor that is meant.
        tensor: TensorName,
        /// Position in it.
        index: usize,
        /// The number.
        found: f32,
    },
    /// Extra bytes between the last tensor and the checksum.
    #[error("{found} bytes after the last tensor, expected none: export the model again")]
    Trailing {
        /// Bytes left.
        found: usize,
    },
    /// A valid model that exceeds the capacity of the encoder's state.
    #[error(
        "model of width {width} with {slots} cache slots (layers x span); this program has room for \
         width {most_width} and {most_slots} slots: train a smaller model"
    )]
    TooLarge {
        /// The model's width.
        width: usize,
        /// Largest width.
        most_width: usize,
        /// The model's layers x span.
        slots: usize,
        /// Most slots.
        most_slots: usize,
    },
}
