//! Errors of creating, writing and reading a journal.

use std::io;
use std::path::{Path, PathBuf};

use super::entry::FORMAT;

/// Greatest length of a journal in bytes: 20 hours.
pub(super) const LARGEST: u64 = 256 << 20;

/// Why a journal is not created or read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The file cannot be created, written or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        #[source]
        source: io::Error,
    },
    /// Another session writes the journal.
    #[error("{} is being written by another session: end that first", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// The first line is incomplete: no sample was recorded.
    #[error("{} has no whole first line: no sample was recorded in it", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The first line is damaged.
    #[error("{}: the first line is damaged, so nobody can say whose it is; it is left as it is", path.display())]
    Headless {
        /// The file.
        path: PathBuf,
    },
    /// The journal is longer than any that this program records.
    #[error("{} has {found} bytes, expected at most {} MiB: it is left as it is, and no recording is made of it", path.display(), LARGEST >> 20)]
    Large {
        /// The file.
        path: PathBuf,
        /// Length in bytes.
        found: u64,
    },
    /// The journal has another format version.
    #[error("{}: format {found}, this program reads {FORMAT}: use the program that wrote it, version {version}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Format version of the journal.
        found: u32,
        /// Version of the program that wrote it.
        version: String,
    },
}

/// Why writing a journal fails.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The disk takes no more.
    #[error("{}: {source}", path.display())]
    Disk {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The disk took no more until the end of the session.
    #[error("{}: {source}; the last {seconds} s of the session are not in it and are lost", path.display())]
    Cut {
        /// The file.
        path: PathBuf,
        /// Upper bound of the missing seconds.
        seconds: usize,
        /// Error of the operating system.
        #[source]
        source: io::Error,
    },
    /// The file was moved or deleted, and cannot be written anew.
    #[error(
        "{} was deleted, moved or replaced, and cannot be written anew: {source}; expected a folder {} that can be written",
        path.display(), folder(path).display()
    )]
    Gone {
        /// Former name of the file.
        path: PathBuf,
        /// Reason why it cannot be written anew.
        #[source]
        source: io::Error,
    },
    /// The file was moved or deleted, and was written anew in another folder at the end.
    #[error(
        "{} was deleted, moved or replaced, and its folder cannot be written: all of the session is in {}; move that file into a folder {}",
        path.display(), found.display(), folder(path).display()
    )]
    Elsewhere {
        /// Former name of the file.
        path: PathBuf,
        /// New name of the file.
        found: PathBuf,
    },
}

/// Folder of a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("."))
}
