//! Reads a model from bytes, and checks every length and number.

use super::{
    ALIGNMENT, CHECKSUM, CHECKSUM_BYTES, FORMAT_VERSION, LARGEST, MAGIC, PREFIX_BYTES,
    error::ModelError,
    header::Header,
    layout::{LayerWeights, LinearWeights, NormWeights, Weights},
    names::TensorName,
    wire_header::WireHeader,
};
use crate::kernels::{GROUP, TILE_ROWS, code_limit};
use crate::model::dimensions::{Dimensions, HEADS};
use crate::units::{CHANNELS, LOOK_BACK, PATCH};

/// A model that borrows its bytes.
#[derive(Clone, Copy, Debug)]
pub struct Model<'m> {
    /// The header.
    pub header: Header<'m>,
    /// The tensors.
    pub(crate) weights: Weights<'m>,
    /// Length of the file in bytes.
    pub length: usize,
    /// CRC-32 at the end of the file, which identifies it.
    pub checksum: u32,
}

impl<'m> Model<'m> {
    /// The model at the start of `region`, which may be longer than the file.
    ///
    /// Nothing is copied. Cost: one pass for the checksum and one over the weights.
    ///
    /// # Errors
    ///
    /// Each kind of damage has its own [`ModelError`]. Nothing after the length is used before the
    /// checksum is right.
    pub fn parse(region: &'m [u8]) -> Result<Self, ModelError> {
        let (length, checksum, body) = checked_body(region)?;
        let found = region.as_ptr().addr() % ALIGNMENT;
        if found != 0 {
            return Err(ModelError::Misaligned { found });
        }
        let (wire, tensors) = postcard::take_from_bytes::<WireHeader<'m>>(body)
            .map_err(|_| ModelError::Header { field: "header" })?;
        let header = wire.interpret()?;
        let mut tensors = Tensors {
            end: PREFIX_BYTES + body.len(),
            rest: tensors,
            layer: None,
        };
        let mut model = Self {
            header,
            weights: Weights::default(),
            length,
            checksum,
        };
        // In place: a board has little stack.
        tensors.read(&model.header.dimensions, &mut model.weights)?;
        match tensors.rest.len() {
            0 => Ok(model),
            found => Err(ModelError::Trailing { found }),
        }
    }
}

/// Length and checksum of the file, and the bytes between prefix and checksum.
fn checked_body(region: &[u8]) -> Result<(usize, u32, &[u8]), ModelError> {
    let too_short = ModelError::TooShort {
        expected: PREFIX_BYTES + CHECKSUM_BYTES,
        found: region.len(),
    };
    if region.len() < PREFIX_BYTES + CHECKSUM_BYTES {
        return Err(too_short);
    }
    let (&magic, rest) = region.split_first_chunk::<8>().ok_or(too_short)?;
    let (&[version], rest) = rest.split_first_chunk::<1>().ok_or(too_short)?;
    let (&length, _) = rest.split_first_chunk::<4>().ok_or(too_short)?;
    if magic != MAGIC {
        return Err(ModelError::Magic { found: magic });
    }
    if version != FORMAT_VERSION {
        return Err(ModelError::Version { found: version });
    }
    let declared = u32::from_le_bytes(length) as usize;
    let wrong_length = ModelError::Length {
        declared,
        available: region.len(),
    };
    if declared < PREFIX_BYTES + CHECKSUM_BYTES {
        return Err(wrong_length);
    }
    let file = region.get(..declared).ok_or(wrong_length)?;
    let (content, &checksum) = file
        .split_last_chunk::<CHECKSUM_BYTES>()
        .ok_or(wrong_length)?;
    let [expected, found] = [CHECKSUM.checksum(content), u32::from_le_bytes(checksum)];
    if expected != found {
        return Err(ModelError::Checksum { expected, found });
    }
    Ok((declared, found, &content[PREFIX_BYTES..]))
}

/// The tensors not yet read, and the layer being read.
struct Tensors<'m> {
    /// Position in the file where `rest` ends.
    end: usize,
    rest: &'m [u8],
    layer: Option<usize>,
}

impl<'m> Tensors<'m> {
    fn read(
        &mut self,
        dimensions: &Dimensions,
        weights: &mut Weights<'m>,
    ) -> Result<(), ModelError> {
        let width = dimensions.width;
        weights.embed = self.linear("embed", width, PATCH * CHANNELS)?;
        for (number, layer) in weights.layers[..dimensions.layers].iter_mut().enumerate() {
            self.layer = Some(number);
            *layer = LayerWeights {
                norm1: self.norm("norm1", width)?,
                qkv: self.linear("qkv", 3 * width, width)?,
                relative_bias: self.floats("relative_bias", "", HEADS * dimensions.span)?,
                out: self.linear("out", width, width)?,
                norm2: self.norm("norm2", width)?,
                ff1: self.linear("ff1", 2 * width, width)?,
                ff2: self.linear("ff2", width, 2 * width)?,
            };
        }
        self.layer = None;
        weights.final_norm = self.norm("final_norm", width)?;
        weights.head = self.linear("head", LOOK_BACK * dimensions.row_outputs(), width)?;
        Ok(())
    }

    fn linear(
        &mut self,
        group: &'static str,
        outputs: usize,
        inputs: usize,
    ) -> Result<LinearWeights<'m>, ModelError> {
        let weights = self.integers(group, outputs.next_multiple_of(TILE_ROWS) * inputs)?;
        let scales = self.scales(group, outputs)?;
        if let Some(index) = silenced(weights, scales, inputs) {
            let tensor = self.name(group, "scales");
            return Err(ModelError::ZeroScale { tensor, index });
        }
        Ok(LinearWeights {
            weights,
            code_limit: code_limit(weights, inputs),
            scales,
            bias: self.floats(group, "bias", outputs)?,
        })
    }

    fn norm(&mut self, group: &'static str, width: usize) -> Result<NormWeights<'m>, ModelError> {
        Ok(NormWeights {
            gain: self.floats(group, "gain", width)?,
            bias: self.floats(group, "bias", width)?,
        })
    }

    fn integers(&mut self, group: &'static str, count: usize) -> Result<&'m [i8], ModelError> {
        let tensor = self.name(group, "weights");
        Ok(bytemuck::cast_slice(self.bytes(tensor, count)?))
    }

    fn scales(&mut self, group: &'static str, count: usize) -> Result<&'m [f32], ModelError> {
        let scales = self.floats(group, "scales", count)?;
        match scales.iter().enumerate().find(|&(_, &scale)| scale < 0.0) {
            None => Ok(scales),
            Some((index, &found)) => Err(ModelError::Scale {
                tensor: self.name(group, "scales"),
                index,
                found,
            }),
        }
    }

    fn floats(
        &mut self,
        group: &'static str,
        part: &'static str,
        count: usize,
    ) -> Result<&'m [f32], ModelError> {
        let tensor = self.name(group, part);
        // Every tensor begins at a multiple of four.
        let floats: &[f32] = bytemuck::cast_slice(self.bytes(tensor, 4 * count)?);
        match floats
            .iter()
            .enumerate()
            .find(|(_, number)| !(-LARGEST..=LARGEST).contains(*number))
        {
            None => Ok(floats),
            Some((index, &found)) => Err(ModelError::Number {
                tensor,
                index,
                found,
            }),
        }
    }

    fn bytes(&mut self, tensor: TensorName, expected: usize) -> Result<&'m [u8], ModelError> {
        let (field, rest) = postcard::take_from_bytes::<&'m [u8]>(self.rest)
            .map_err(|_| ModelError::WeightsEnd { tensor })?;
        let start = self.end - rest.len() - field.len();
        let pad = start.next_multiple_of(ALIGNMENT) - start;
        let bytes = field.get(pad..).unwrap_or_default();
        if bytes.len() != expected {
            return Err(ModelError::WeightLength {
                tensor,
                expected,
                found: bytes.len(),
            });
        }
        self.rest = rest;
        Ok(bytes)
    }

    const fn name(&self, group: &'static str, part: &'static str) -> TensorName {
        TensorName {
            layer: self.layer,
            group,
            part,
        }
    }
}

/// The first row with a scale of zero and a weight other than zero; the quantizer gives that scale to rows of zeros alone.
fn silenced(weights: &[i8], scales: &[f32], inputs: usize) -> Option<usize> {
    let tiles = weights.chunks_exact(TILE_ROWS * inputs);
    let mut rows = tiles
        .flat_map(|tile| (0..TILE_ROWS).map(move |row| (tile, row)))
        .zip(scales);
    rows.position(|((tile, row), &scale)| {
        // A row's columns come by four, in turn with those of the other rows.
        let mut columns = tile.chunks_exact(GROUP).skip(row).step_by(TILE_ROWS);
        scale == 0.0 && columns.any(|four| four != [0; GROUP])
    })
}
