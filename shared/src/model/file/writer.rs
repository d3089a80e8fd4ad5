//! Writes a quantized student to a file.

use alloc::{string::String, vec, vec::Vec};

use serde::Serialize;

use super::{
    ALIGNMENT, CHECKSUM, CHECKSUM_BYTES, FORMAT_VERSION, MAGIC, PREFIX_BYTES, error::ModelError,
    header::SmootherDefaults, reader::Model, wire_aggregation::WireAggregation,
    wire_header::WireHeader,
};
use crate::intent::{Intent, MAX_CLASSES};
use crate::kernels::{packing::packed, row};
use crate::model::dimensions::{Companding, Dimensions, HEADS};
use crate::stream::alignment::Template;
use crate::stream::preprocess::{DIVISOR, Preprocessing};
use crate::stream::smoother::Margins;
use crate::units::{LOOK_BACK, PATCH, SAMPLE_RATE_HZ};

/// A linear map with quantized rows.
#[derive(Clone, PartialEq, Debug)]
pub struct LinearParts {
    /// Row-major `[outputs][inputs]`, the bytes of the weights: a weight's value is that of its byte and of the byte
    /// before it ([`LinearParts::dequantized`]); the file has them in tiles.
    pub weights: Vec<i8>,
    /// Value of a weight byte of 1, one per output.
    pub scales: Vec<f32>,
    /// Bias, one per output.
    pub bias: Vec<f32>,
}

impl LinearParts {
    /// Quantizes a row-major `[outputs][inputs]` matrix with one bias per output.
    #[must_use]
    pub fn quantized(weights: &[f32], bias: Vec<f32>) -> Self {
        let columns = weights.len().checked_div(bias.len()).unwrap_or(0);
        let (weights, scales) = quantize_rows(weights, bias.len(), columns);
        Self {
            weights,
            scales,
            bias,
        }
    }
}

/// A layer norm.
#[derive(Clone, PartialEq, Debug)]
pub struct NormParts {
    /// Factors, `[d]`.
    pub gain: Vec<f32>,
    /// Terms, `[d]`.
    pub bias: Vec<f32>,
}

/// Tensors of one pre-norm layer.
#[derive(Clone, PartialEq, Debug)]
pub struct LayerParts {
    /// Norm before attention.
    pub norm1: NormParts,
    /// d -> 3d: query, key, value.
    pub qkv: LinearParts,
    /// `[heads][span]` row-major: added to the score of a patch, by its age in patches.
    pub relative_bias: Vec<f32>,
    /// d -> d.
    pub out: LinearParts,
    /// Norm before the feed-forward.
    pub norm2: NormParts,
    /// d -> 2d.
    pub ff1: LinearParts,
    /// 2d -> d.
    pub ff2: LinearParts,
}

/// Provenance of a model.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ProvenanceParts {
    /// Names of the data sets.
    pub data_sets: Vec<String>,
    /// Subjects trained on or validated with, ancestors' included, as `data set/subject`.
    pub subjects_seen: Vec<String>,
    /// Subjects left out of the training, as `data set/subject`.
    pub subjects_left_out: Vec<String>,
    /// Revision of the training program.
    pub git_revision: String,
    /// Random seed of the training.
    pub seed: u64,
    /// Name and value of measured metrics.
    pub metrics: Vec<(String, f32)>,
}

/// A model that owns its tensors.
#[derive(Clone, PartialEq, Debug)]
pub struct ModelParts {
    /// Dimensions of the tensors.
    pub dimensions: Dimensions,
    /// Companding of the input.
    pub companding: Companding,
    /// Processing between the armband and the input.
    pub preprocessing: Preprocessing,
    /// Default settings of the smoother.
    pub smoother: SmootherDefaults,
    /// Pattern of an open hand, for alignment.
    pub template: Option<Template>,
    /// Provenance.
    pub provenance: ProvenanceParts,
    /// 80 -> d.
    pub embed: LinearParts,
    /// The layers in order.
    pub layers: Vec<LayerParts>,
    /// Norm before the head.
    pub final_norm: NormParts,
    /// d -> 6 x [row outputs](Dimensions::row_outputs).
    pub head: LinearParts,
}

impl ModelParts {
    /// The file's bytes.
    ///
    /// # Errors
    ///
    /// Errors of [`Model::parse`]: an invalid model is refused before it is written.
    pub fn to_bytes(&self) -> Result<Vec<u8>, ModelError> {
        let bytes = self.emit();
        Model::parse(&bytes)?;
        Ok(bytes)
    }

    /// The file's bytes, unchecked.
    pub(super) fn emit(&self) -> Vec<u8> {
        let provenance = &self.provenance;
        let intents = self.dimensions.vocabulary.intents();
        // A number too large for its field becomes the largest value, which the reader refuses.
        let byte = |number: usize| u8::try_from(number).unwrap_or(u8::MAX);
        let short = |number: usize| u16::try_from(number).unwrap_or(u16::MAX);
        let Margins {
            entry,
            other,
            early,
        } = self.smoother.margins;
        let mut entry_margins = [entry; MAX_CLASSES];
        entry_margins[Intent::Relax.class()] = 0.0;
        let template = self.template.map(|template| template.to_bytes());
        let header = WireHeader {
            width: short(self.dimensions.width),
            heads: HEADS as u8,
            layers: byte(self.dimensions.layers),
            span: byte(self.dimensions.span),
            patch: PATCH as u8,
            look_back: LOOK_BACK as u8,
            classes: byte(intents.len()),
            companding: match self.companding {
                Companding::Linear => 0,
                Companding::SquareRoot => 1,
            },
            class_names: &list(intents.iter().map(|intent| intent.name())),
            sample_rate_hz: SAMPLE_RATE_HZ,
            median_width: self.preprocessing.median.width(),
            divisor: DIVISOR,
            normalized: self.preprocessing.normalized,
            aggregation: WireAggregation::new(self.smoother.aggregation, early),
            look_ahead: short(self.smoother.look_ahead),
            hold: short(self.smoother.hold),
            entry_margins,
            other_margin: other,
            template: template.as_ref().map_or(&[], |bytes| &bytes[..]),
            data_sets: &list(&provenance.data_sets),
            subjects_seen: &list(&provenance.subjects_seen),
            subjects_left_out: &list(&provenance.subjects_left_out),
            git_revision: &provenance.git_revision,
            seed: provenance.seed,
            metrics: &list(&provenance.metrics),
        };
        let mut file = prefix();
        append(&mut file, &header);
        append_linear(&mut file, &self.embed);
        for layer in &self.layers {
            append_norm(&mut file, &layer.norm1);
            append_linear(&mut file, &layer.qkv);
            append_floats(&mut file, &layer.relative_bias);
            append_linear(&mut file, &layer.out);
            append_norm(&mut file, &layer.norm2);
            append_linear(&mut file, &layer.ff1);
            append_linear(&mut file, &layer.ff2);
        }
        append_norm(&mut file, &self.final_norm);
        append_linear(&mut file, &self.head);
        seal(&mut file);
        file
    }
}

/// Quantizes each row ([`row::quantize`]): bytes row-major, and one scale per row. An infinite or NaN scale is refused by
/// [`ModelParts::to_bytes`].
#[must_use]
pub(super) fn quantize_rows(matrix: &[f32], rows: usize, columns: usize) -> (Vec<i8>, Vec<f32>) {
    let mut bytes = vec![0; matrix.len()];
    let mut scales = vec![0.0; rows];
    let rows = matrix.chunks(columns.max(1));
    for ((weights, bytes), scale) in rows.zip(bytes.chunks_mut(columns.max(1))).zip(&mut scales) {
        *scale = row::quantize(weights, bytes);
    }
    (bytes, scales)
}

/// Magic, version and four bytes for the length.
pub(super) fn prefix() -> Vec<u8> {
    let mut file = MAGIC.to_vec();
    file.push(FORMAT_VERSION);
    file.extend([0; 4]);
    file
}

/// Writes the length and appends the checksum.
pub(super) fn seal(file: &mut Vec<u8>) {
    let length = u32::try_from(file.len() + CHECKSUM_BYTES).unwrap_or(u32::MAX);
    file[MAGIC.len() + 1..PREFIX_BYTES].copy_from_slice(&length.to_le_bytes());
    let checksum = CHECKSUM.checksum(file);
    file.extend(checksum.to_le_bytes());
}

/// Items without their number.
pub(super) fn list<T: Serialize>(items: impl IntoIterator<Item = T>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for item in items {
        append(&mut bytes, &item);
    }
    bytes
}

pub(super) fn append<T: Serialize + ?Sized>(file: &mut Vec<u8>, item: &T) {
    // Fails only for a sequence of unknown length or a custom serializer; there is neither.
    let bytes = postcard::to_allocvec(item).expect("slices, texts and numbers always serialize");
    file.extend(bytes);
}

fn append_linear(file: &mut Vec<u8>, linear: &LinearParts) {
    let columns = linear.weights.len().checked_div(linear.bias.len());
    let tiles = packed(&linear.weights, columns.unwrap_or(0));
    append_tensor(file, bytemuck::cast_slice(&tiles));
    append_floats(file, &linear.scales);
    append_floats(file, &linear.bias);
}

fn append_norm(file: &mut Vec<u8>, norm: &NormParts) {
    append_floats(file, &norm.gain);
    append_floats(file, &norm.bias);
}

fn append_floats(file: &mut Vec<u8>, floats: &[f32]) {
    let bytes: Vec<u8> = floats
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    append_tensor(file, &bytes);
}

/// Appends zeros up to a multiple of four bytes, then the bytes.
fn append_tensor(file: &mut Vec<u8>, bytes: &[u8]) {
    // The length that comes first includes the zeros. They never make it a byte longer: tensors are whole
    // words, and the largest lengths of one and two bytes, 127 and 16 383, are a multiple of four plus 3.
    let start = file.len() + list([bytes.len()]).len();
    let pad = start.next_multiple_of(ALIGNMENT) - start;
    append::<[u8]>(file, &[&[0; ALIGNMENT][..pad], bytes].concat());
}
