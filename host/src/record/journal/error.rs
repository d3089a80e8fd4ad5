//! Why a journal is not begun, not written on or not read.

use std::io;
use std::path::{Path, PathBuf};

use super::entry::FORMAT;

/// Most bytes of a journal: 20 hours.
pub(super) const LARGEST: u64 = 256 << 20;

/// Why a journal is not begun or not read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// It cannot be made, written or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// A session writes it.
    #[error("{} is being written by another session: end that first", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// Its first line was being written: no sample was recorded.
    #[error("{} has no whole first line: no sample was recorded in it", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// It does not begin as a journal does.
    #[error("{}: the first line is damaged, so nobody can say whose it is; it is left as it is", path.display())]
    Headless {
        /// The file.
        path: PathBuf,
    },
    /// Longer than any session that this program records.
    #[error("{} has {found} bytes, expected at most {} MiB: it is left as it is, and no recording is made of it", path.display(), LARGEST >> 20)]
    Large {
        /// The file.
        path: PathBuf,
        /// Its length.
        found: u64,
    },
    /// Of a later program.
    #[error("{}: format {found}, this program reads {FORMAT}: use the program that wrote it, version {version}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What it says.
        found: u32,
        /// Of the program.
        version: String,
    },
}

/// Why a journal is not written on.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The disk takes no more.
    #[error("{}: {source}", path.display())]
    Disk {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// The disk has taken no more until the end.
    #[error("{}: {source}; the last {seconds} s of the session are not in it and are lost", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// At most so much is missing.
        seconds: usize,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// The file has lost its name, and gets no other one.
    #[error(
        "{} was deleted, moved or replaced, and cannot be written anew: {source}; expected a folder {} that can be written",
        path.display(), folder(path).display()
    )]
    Gone {
        /// The name that it had.
        path: PathBuf,
        /// Why it cannot be written anew.
        #[source]
        source: io::Error,
    },
    /// The file has lost its name, and got one in another folder at the end.
    #[error(
        "{} was deleted, moved or replaced, and its folder cannot be written: all of the session is in {}; move that file into a folder {}",
        path.display(), found.display(), folder(path).display()
    )]
    Elsewhere {
        /// The name that it had.
        path: PathBuf,
        /// The name that it has.
        found: PathBuf,
    },
}

/// The folder of a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("."))
}
