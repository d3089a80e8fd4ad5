//! The model file (`*.intent`): one postcard message and its CRC-32, read in place.
//!
//! [`Model::parse`] proves every length, dimension and number once; after it nothing about a model
//! can fail but its fit to a compiled [`Encoder`](crate::model::encoder::Encoder). Weights stay where they
//! lie, in flash or in a buffer, as the words they are: the bytes begin at a multiple of four. Byte by byte: docs/model-file.md.

mod error;
mod header;
mod layout;
#[cfg(any(test, feature = "write"))]
pub mod random;
mod reader;
#[cfg(any(test, feature = "write"))]
mod writer;

pub use error::{Excerpt, ModelError, TensorName};
pub use header::{Header, List, Provenance, SmootherDefaults};
pub use layout::{LayerWeights, LinearWeights, NormWeights, Weights};
pub use reader::Model;
#[cfg(test)]
pub(crate) use writer::overwrite;
#[cfg(any(test, feature = "write"))]
pub use writer::{LayerParts, LinearParts, ModelParts, NormParts, ProvenanceParts, quantize_rows};

/// First bytes of every model file.
pub const MAGIC: [u8; 8] = *b"myointnt";
/// The format that this crate reads and writes.
pub const FORMAT_VERSION: u8 = 2;
/// The file in memory, and every tensor in the file, begins at a multiple of so many bytes.
pub const ALIGNMENT: usize = align_of::<f32>();

// Numbers are read where they lie.
const _: () = assert!(cfg!(target_endian = "little") && ALIGNMENT == 4);
/// Magic, version and length: what can be read before the length is known.
const PREFIX_BYTES: usize = MAGIC.len() + 1 + 4;
/// The CRC-32 at the end, little endian.
const CHECKSUM_BYTES: usize = 4;

/// CRC-32 as Ethernet, zip and PNG compute it.
const CHECKSUM: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

#[cfg(test)]
mod tests;
