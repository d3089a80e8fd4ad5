//! What the published sets say in the names of files and folders.

use std::path::Path;

/// Name of the file without its ending.
pub(crate) fn stem(path: &Path) -> Option<&str> {
    path.file_stem()?.to_str()
}

/// Name of the folder `levels` above the file: 1 is the folder it lies in.
pub(crate) fn folder(path: &Path, levels: usize) -> Option<&str> {
    path.ancestors().nth(levels)?.file_name()?.to_str()
}
