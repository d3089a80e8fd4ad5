//! The model file (`*.intent`): one postcard message and its CRC-32, read in place.
//!
//! [`Model::parse`] checks every length, dimension and number once; after it only the capacity of an
//! encoder can refuse a model. Weights are not copied: they are read as words where they are, in flash
//! or in a buffer that begins at a multiple of four bytes. Format: docs/model-file.md.

mod decimal;
mod error;
mod header;
mod layout;
mod names;
#[cfg(any(test, feature = "write"))]
mod owned;
#[cfg(any(test, feature = "write"))]
pub mod random;
mod reader;
mod wire_aggregation;
mod wire_header;
#[cfg(any(test, feature = "write"))]
mod writer;

pub use error::ModelError;
pub use header::{Header, List, Provenance, SmootherDefaults};
pub(crate) use layout::{LayerWeights, LinearWeights, NormWeights, Weights};
pub use names::{Excerpt, TensorName};
pub use reader::Model;
#[cfg(any(test, feature = "write"))]
pub use writer::{LayerParts, LinearParts, ModelParts, NormParts, ProvenanceParts};

/// First bytes of every model file.
pub const MAGIC: [u8; 8] = *b"myointnt";
/// The format version that this crate reads and writes.
const FORMAT_VERSION: u8 = 7;
/// Largest magnitude of a number in a tensor. A trained model's are below 10; up to this bound no sum, product or square
/// on the way to the logits leaves the range of f32, whatever the input: a layer norm gives at most
/// 100 x sqrt(128) + 100 < 2e3, a linear map of 256 inputs 100 x 128 x 256 x 2e3 < 1e10, the map after attention or the
/// feed-forward 100 x 128 x 256 x 1e10 < 1e17, a square of three layers' sum < 1e36.
const LARGEST: f32 = 100.0;

/// Whether a tensor may hold all these numbers; NaN is refused.
pub(crate) fn holds(numbers: &[f32]) -> bool {
    numbers.iter().all(|number| number.abs() <= LARGEST)
}

/// The file in memory and every tensor in the file begin at a multiple of this many bytes.
const ALIGNMENT: usize = align_of::<f32>();

// Numbers are read in place.
const _: () = assert!(cfg!(target_endian = "little") && ALIGNMENT == 4);
/// Magic, version and length.
const PREFIX_BYTES: usize = MAGIC.len() + 1 + 4;
/// The CRC-32 at the end, little endian.
const CHECKSUM_BYTES: usize = 4;

/// CRC-32 as Ethernet, zip and PNG compute it.
const CHECKSUM: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

#[cfg(test)]
mod tests;
