//! Files of recordings: the published formats, and what their readers share.

pub(crate) mod error;
pub mod label_file;
pub(crate) mod libemg;
pub mod mat;
pub mod npy;
pub mod open;
pub mod path;
pub(crate) mod table;

use std::path::Path;

use error::LoadError;
use execution::bounded_read;

/// Bytes of a file of recordings or labels.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, LoadError> {
    let bytes = bounded_read::read(path, bounded_read::RECORDING);
    bytes.map_err(|source| LoadError::io(path, source))
}
