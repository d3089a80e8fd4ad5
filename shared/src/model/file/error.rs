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
#[expect(missing_docs, reason = "the messages say it")]
pub enum ModelError {
    #[error(
        "starts {found} bytes after a multiple of {ALIGNMENT} in memory: copy it to an aligned buffer"
    )]
    Misaligned { found: usize },
    #[error("{found} bytes, a model has at least {expected}: write the file again")]
    TooShort { expected: usize, found: usize },
    #[error("starts with {found:02x?}, a model with {MAGIC:02x?}: give an .intent file")]
    Magic { found: [u8; 8] },
    #[error("model format {found}, this build reads {FORMAT_VERSION}: export the model again")]
    Version { found: u8 },
    #[error("declares {declared} bytes, {available} are available: copy the whole file again")]
    Length { declared: usize, available: usize },
    #[error("checksum {found:08x}, computed {expected:08x}: copy the file again")]
    Checksum { expected: u32, found: u32 },
    #[error("malformed header field `{field}`: export the model again")]
    Header { field: &'static str },
    #[error(
        "width {found}, expected a multiple of 8, {MIN_WIDTH} to {MAX_WIDTH}: train a supported width"
    )]
    Width { found: usize },
    #[error("{what} {found}, expected {least} to {most}: train or export it for this program")]
    OutOfRange {
        what: &'static str,
        found: usize,
        least: usize,
        most: usize,
    },
    #[error(
        "the newest {LOOK_BACK} patches depend on {found} patches, the window has \
         {WINDOW_PATCHES}: shorten the span or drop a layer"
    )]
    ReceptiveField { found: usize },
    #[error("{found} classes, expected 3, 5 or 6: train one of the three vocabularies")]
    Classes { found: usize },
    #[error("{found} class names for {expected} classes: export the model again")]
    ClassCount { expected: usize, found: usize },
    #[error(
        "class {class} is named `{found}`, expected `{expected}`: train the vocabulary's order"
    )]
    ClassName {
        class: usize,
        expected: &'static str,
        found: Excerpt,
    },
    #[error("median of {found} samples, expected 3, or 1 for none: train with either")]
    MedianWidth { found: u8 },
    #[error("alignment template: {0}")]
    Template(#[from] TemplateError),
    #[error("entry margin {}, expected one of 0 to {} for all classes: export with it", Decimal(.found), Decimal(&MAX_ENTRY_MARGIN))]
    EntryMargin { found: f32 },
    #[error(
        "margin of early labels {}, expected 0 to {}, and 1 and 0.5 for relax: export with them",
        Decimal(.found), Decimal(&MAX_ENTRY_MARGIN)
    )]
    EarlyMargin { found: f32 },
    #[error(
        "margin over other movement {}, expected -{} to {}: export with one",
        Decimal(.found), Decimal(&MAX_ENTRY_MARGIN), Decimal(&MAX_ENTRY_MARGIN)
    )]
    OtherMargin { found: f32 },
    #[error(
        "this model does not know movement outside the vocabulary: it has no margin over it; train one with data.other_movement = \"class\""
    )]
    NoOther,
    #[error(
        "the head is one for a model of other dimensions: take the model that it was learnt with"
    )]
    OtherHead,
    #[error("a metric is {}, expected a finite number: evaluate and export the model again", Decimal(.found))]
    Metric { found: f32 },
    #[error("{tensor} has {found} bytes, expected {expected}: export the model again")]
    WeightLength {
        tensor: TensorName,
        expected: usize,
        found: usize,
    },
    #[error("the file ends within {tensor}: export the model again")]
    WeightsEnd { tensor: TensorName },
    #[error("{tensor} holds {} at {index}, expected 0 or more: quantize the model again", Decimal(.found))]
    Scale {
        tensor: TensorName,
        index: usize,
        found: f32,
    },
    #[error(
        "{tensor} holds 0 at {index}, where the row has weights; expected more than 0: quantize the model again"
    )]
    ZeroScale { tensor: TensorName, index: usize },
    #[error(
        "{tensor} holds {} at {index}, expected a number from -{} to {}: train the model again",
        Decimal(.found), Decimal(&LARGEST), Decimal(&LARGEST)
    )]
    Number {
        tensor: TensorName,
        index: usize,
        found: f32,
    },
    #[error("{found} bytes after the last tensor, expected none: export the model again")]
    Trailing { found: usize },
    #[error(
        "model of width {width} with {slots} cache slots (layers x span); this program has room for \
         width {most_width} and {most_slots} slots: train a smaller model"
    )]
    TooLarge {
        width: usize,
        most_width: usize,
        slots: usize,
        most_slots: usize,
    },
}
