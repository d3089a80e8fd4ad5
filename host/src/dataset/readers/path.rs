//! Names of files and folders, which identify person and gesture in the published sets.

use std::path::Path;

/// Name of the file without its ending.
pub(crate) fn stem(path: &Path) -> Option<&str> {
    path.file_stem()?.to_str()
}

/// Name of the folder `levels` above the file: 1 is the folder it lies in.
pub(crate) fn folder(path: &Path, levels: usize) -> Option<&str> {
    path.ancestors().nth(levels)?.file_name()?.to_str()
}

/// Name of a folder above the file if it is a prefix and digits: `user10`.
pub(crate) fn numbered<'p>(path: &'p Path, levels: usize, prefix: &str) -> Option<&'p str> {
    folder(path, levels).filter(|name| name.strip_prefix(prefix).is_some_and(is_number))
}

/// Whether a text is digits alone.
pub(crate) fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}
