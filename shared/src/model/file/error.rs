//! Why a model is refused: one cause per variant.

use core::fmt;

use super::{ALIGNMENT, FORMAT_VERSION, MAGIC};
use crate::model::dimensions::{HEADS, MAX_LAYERS, MAX_SPAN, MAX_WIDTH, MIN_WIDTH};
use crate::units::{LOOK_BACK, PATCH, SAMPLE_RATE_HZ, WINDOW_PATCHES};

/// Why bytes are not a model for this build.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// In memory where its numbers cannot be read.
    #[error(
        "lies {found} bytes behind a multiple of {ALIGNMENT} in memory: put it into a buffer that begins at one"
    )]
    Misaligned {
        /// Bytes beyond the multiple.
        found: usize,
    },
    /// Not even room for the first fields and the checksum.
    #[error("{found} bytes, a model has at least {expected}: write the file again")]
    TooShort {
        /// Fewest bytes of any model.
        expected: usize,
        /// Bytes given.
        found: usize,
    },
    /// Some other file, or an erased region.
    #[error("starts with {found:02x?}, a model with {MAGIC:02x?}: give an .intent file")]
    Magic {
        /// The first bytes.
        found: [u8; 8],
    },
    /// Another format.
    #[error("model format {found}, this build reads {FORMAT_VERSION}: export the model again")]
    Version {
        /// The file's format.
        found: u8,
    },
    /// The file says another length than there is room for.
    #[error("says it has {declared} bytes, {available} are there: copy the whole file again")]
    Length {
        /// Length in the file.
        declared: usize,
        /// Bytes given.
        available: usize,
    },
    /// A byte differs from what was written.
    #[error("checksum {found:08x}, computed {expected:08x}: copy the file again")]
    Checksum {
        /// CRC-32 of the bytes.
        expected: u32,
        /// CRC-32 in the file.
        found: u32,
    },
    /// The header ends early or holds a malformed number, text or list.
    #[error("malformed header field `{field}`: export the model again")]
    Header {
        /// What could not be read.
        field: &'static str,
    },
    /// Width d of the residual stream.
    #[error(
        "width {found}, expected a multiple of 8, {MIN_WIDTH} to {MAX_WIDTH}: train a supported width"
    )]
    Width {
        /// The file's width.
        found: usize,
    },
    /// Attention heads.
    #[error("{found} attention heads, this build has {HEADS}: train with {HEADS}")]
    Heads {
        /// The file's heads.
        found: usize,
    },
    /// Layers.
    #[error("{found} layers, expected 1 to {MAX_LAYERS}: train with fewer")]
    Layers {
        /// The file's layers.
        found: usize,
    },
    /// Patches that attention sees.
    #[error("attention span {found}, expected 1 to {MAX_SPAN}: train with a shorter span")]
    Span {
        /// The file's span.
        found: usize,
    },
    /// The answer would depend on more than the ring holds.
    #[error(
        "the newest {LOOK_BACK} patches depend on {found} patches, the window has \
         {WINDOW_PATCHES}: shorten the span or drop a layer"
    )]
    ReceptiveField {
        /// Patches that the look-back outputs depend on.
        found: usize,
    },
    /// Samples per patch.
    #[error("patches of {found} samples, this build cuts {PATCH}: train with {PATCH}")]
    Patch {
        /// The file's patch.
        found: usize,
    },
    /// Rows of the head.
    #[error("{found} look-back rows, this build reads {LOOK_BACK}: train with {LOOK_BACK}")]
    LookBack {
        /// The file's rows.
        found: usize,
    },
    /// Classes.
    #[error("{found} classes, expected 3 or 6: train one of the two vocabularies")]
    Classes {
        /// The file's classes.
        found: usize,
    },
    /// How samples become numbers.
    #[error("companding {found}, expected 0 (linear) or 1 (square root): update this program")]
    Companding {
        /// The file's code.
        found: u8,
    },
    /// As many names as classes.
    #[error("{found} class names for {expected} classes: export the model again")]
    ClassCount {
        /// Classes.
        expected: usize,
        /// Names.
        found: usize,
    },
    /// The vocabulary's order is fixed.
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
    /// Samples per second.
    #[error("{found} samples per second, the line runs at {SAMPLE_RATE_HZ}: train at that rate")]
    SampleRate {
        /// The file's rate.
        found: u32,
    },
    /// Preprocessing: width of the median.
    #[error("median of {found} samples, the line takes 3: train with that preprocessing")]
    MedianWidth {
        /// The file's width.
        found: u8,
    },
    /// Preprocessing: what a sample is divided by.
    #[error("samples divided by {found}, the line divides by 128: train with that preprocessing")]
    Divisor {
        /// The file's divisor.
        found: u8,
    },
    /// The smoother's aggregation mode.
    #[error(
        "smoother aggregation mode {found}, expected 0 (all rows) or 1 (same instant): update this program"
    )]
    AggregationMode {
        /// The file's code.
        found: u8,
    },
    /// The smoother's likelihood.
    #[error("likelihood {found}, expected 0 (logits): export the model again")]
    Likelihood {
        /// The file's code.
        found: u8,
    },
    /// The smoother's look-ahead.
    #[error("look-ahead {found} samples, expected whole patches up to {most}: export with one")]
    LookAhead {
        /// Longest look-ahead.
        most: usize,
        /// The file's look-ahead.
        found: usize,
    },
    /// The smoother's hold.
    #[error("hold {found} samples, expected whole patches, at least one: export with one")]
    Hold {
        /// The file's hold.
        found: usize,
    },
    /// A tensor has another length than the dimensions say.
    #[error("{tensor} has {found} bytes, expected {expected}: export the model again")]
    WeightLength {
        /// Which tensor.
        tensor: TensorName,
        /// Bytes by the dimensions.
        expected: usize,
        /// Bytes in the file.
        found: usize,
    },
    /// The weights end before this tensor does.
    #[error("the file ends within {tensor}: export the model again")]
    WeightsEnd {
        /// Which tensor.
        tensor: TensorName,
    },
    /// A weight of -128 could overflow an accumulator.
    #[error("{tensor} holds -128 at {index}, expected -127 to 127: quantize the model again")]
    WeightRange {
        /// Which tensor.
        tensor: TensorName,
        /// Position in it.
        index: usize,
    },
    /// A scale has to be finite and not negative.
    #[error("{tensor} holds {found} at {index}, expected 0 or more: quantize the model again")]
    Scale {
        /// Which tensor.
        tensor: TensorName,
        /// Position in it.
        index: usize,
        /// The number.
        found: f32,
    },
    /// An infinite number, or none.
    #[error("{tensor} holds {found} at {index}, expected a finite number: train the model again")]
    NotFinite {
        /// Which tensor.
        tensor: TensorName,
        /// Position in it.
        index: usize,
        /// The number.
        found: f32,
    },
    /// Bytes between the last tensor and the checksum.
    #[error("{found} bytes after the last tensor, expected none: export the model again")]
    Trailing {
        /// Bytes left.
        found: usize,
    },
    /// A good model that the encoder's state has no room for.
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

/// Which tensor an error speaks of, as `layers[1].qkv.scales`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TensorName {
    /// Layer number, none for the tensors outside the layers.
    pub layer: Option<usize>,
    /// The group: `qkv`.
    pub group: &'static str,
    /// The tensor in its group: `scales`. Empty if the group is one tensor.
    pub part: &'static str,
}

impl fmt::Display for TensorName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(layer) = self.layer {
            write!(out, "layers[{layer}].")?;
        }
        out.write_str(self.group)?;
        if self.part.is_empty() {
            return Ok(());
        }
        write!(out, ".{}", self.part)
    }
}

/// The first 16 bytes of a text, kept so that an error needs no lifetime.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Excerpt {
    bytes: [u8; 16],
    length: u8,
}

impl Excerpt {
    pub(super) fn of(text: &str) -> Self {
        let mut bytes = [0; 16];
        let mut end = text.len().min(bytes.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
        Self {
            bytes,
            length: end as u8,
        }
    }
}

impl fmt::Display for Excerpt {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = &self.bytes[..usize::from(self.length)];
        out.write_str(core::str::from_utf8(text).unwrap_or_default())
    }
}
