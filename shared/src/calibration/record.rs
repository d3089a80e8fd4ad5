//! Record of a calibration: the bytes that a device keeps over a loss of power.
//!
//! ```text
//! 0..4    "MyoC"
//! 4       version, 1
//! 5       width
//! 6       outputs
//! 7       alignment under which it was learnt: places, and 8 if mirrored
//! 8..12   CRC-32 of its model file
//! 12..    tiles of weights, scales, biases: as in the model file
//! end     CRC-32 of the bytes before
//! ```
//!
//! Numbers are little-endian.

use crate::checksum::crc32;
use crate::kernels::TILE_ROWS;
use crate::kernels::code_limit;
use crate::model::dimensions::Dimensions;
use crate::model::file::{LinearWeights, Model};
use crate::model::head::{Head, MAX_HEAD_WIDTH, MAX_OUTPUTS, are_allowed};
use crate::stream::alignment::Alignment;
use crate::units::{CHANNELS, LOOK_BACK};

const MAGIC: [u8; 4] = *b"MyoC";
const VERSION: u8 = 1;
const HEAD_START: usize = 12;
const CHECKSUM_BYTES: usize = 4;
/// In the byte of the alignment: the electrodes run the other way round.
const MIRRORED: u8 = CHANNELS as u8;
/// Longest record: of six classes and other movement at width 64. One of three classes and other movement has 1744 bytes.
pub const RECORD_BYTES: usize = HEAD_START
    + MAX_OUTPUTS.next_multiple_of(TILE_ROWS) * MAX_HEAD_WIDTH
    + 2 * 4 * MAX_OUTPUTS
    + CHECKSUM_BYTES;

// A page of flash holds any record.
const _: () = assert!(RECORD_BYTES <= 4096);

/// Reason why a record is not used.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum RecordError {
    #[error("no calibration is kept")]
    Missing,
    #[error("calibration of version {found}, this firmware reads {VERSION}: calibrate again")]
    Version { found: u8 },
    #[error("the calibration is damaged: calibrate again")]
    Damaged,
    #[error("the calibration is of model {found:08x}, here is {expected:08x}: calibrate again")]
    WrongModel { expected: u32, found: u32 },
}

/// Head of a record, read where it is.
#[derive(Clone, Copy, Debug)]
pub struct KeptHead<'b> {
    pub(crate) weights: LinearWeights<'b>,
    /// Alignment under which it was learnt.
    pub alignment: Alignment,
}

/// Writes the record of a head that was learnt under an alignment, for the model with this CRC-32; returns its bytes, a
/// multiple of four.
#[must_use]
pub fn to_record<'b>(
    head: &Head,
    alignment: Alignment,
    model: u32,
    bytes: &'b mut [u8; RECORD_BYTES],
) -> &'b [u8] {
    bytes[..4].copy_from_slice(&MAGIC);
    let place = alignment.turn() + if alignment.mirrored() { MIRRORED } else { 0 };
    bytes[4..8].copy_from_slice(&[VERSION, head.width as u8, head.outputs as u8, place]);
    bytes[8..HEAD_START].copy_from_slice(&model.to_le_bytes());
    let tiles = bytemuck::cast_slice(head.tiles());
    bytes[HEAD_START..][..tiles.len()].copy_from_slice(tiles);
    let mut end = HEAD_START + tiles.len();
    for numbers in [&head.scales, &head.bias] {
        for number in &numbers[..head.outputs] {
            bytes[end..][..4].copy_from_slice(&number.to_le_bytes());
            end += 4;
        }
    }
    let checksum = crc32(&bytes[..end]);
    bytes[end..][..CHECKSUM_BYTES].copy_from_slice(&checksum.to_le_bytes());
    &bytes[..end + CHECKSUM_BYTES]
}

/// Reads the record at the start of some bytes, which begin at a multiple of four and may go on behind it.
pub fn from_record<'b>(bytes: &'b [u8], model: &Model<'_>) -> Result<KeptHead<'b>, RecordError> {
    let (start, body) = bytes
        .split_first_chunk::<HEAD_START>()
        .ok_or(RecordError::Missing)?;
    let [a, b, c, d, version, width, outputs, place, found @ ..] = *start;
    if [a, b, c, d] != MAGIC {
        return Err(RecordError::Missing);
    }
    if version != VERSION {
        return Err(RecordError::Version { found: version });
    }
    let (width, outputs) = (usize::from(width), usize::from(outputs));
    let tiles = outputs.next_multiple_of(TILE_ROWS) * width;
    let end = tiles + 2 * 4 * outputs;
    let (covered, checksum) = bytes
        .get(..HEAD_START + end + CHECKSUM_BYTES)
        .and_then(<[u8]>::split_last_chunk)
        .ok_or(RecordError::Damaged)?;
    if place >= 2 * MIRRORED || crc32(covered).to_le_bytes() != *checksum {
        return Err(RecordError::Damaged);
    }
    let (expected, found) = (model.checksum, u32::from_le_bytes(found));
    if found != expected {
        return Err(RecordError::WrongModel { expected, found });
    }
    let dimensions: &Dimensions = &model.header.dimensions;
    let is_of_shape = (width, outputs) == (dimensions.width, LOOK_BACK * dimensions.row_outputs());
    let numbers: &[f32] =
        bytemuck::try_cast_slice(&body[tiles..end]).map_err(|_| RecordError::Damaged)?;
    let (scales, bias) = numbers.split_at(outputs);
    if !is_of_shape || width > MAX_HEAD_WIDTH || !are_allowed(scales, bias) {
        return Err(RecordError::Damaged);
    }
    let weights = bytemuck::cast_slice(&body[..tiles]);
    Ok(KeptHead {
        weights: LinearWeights {
            weights,
            code_limit: code_limit(weights, width),
            scales,
            bias,
        },
        alignment: Alignment::new(place, place >= MIRRORED),
    })
}
