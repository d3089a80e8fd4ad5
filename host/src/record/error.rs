//! Errors of guided recording: journals, and the recordings made of them.

use std::io;
use std::path::{Path, PathBuf};

use super::journal::LARGEST;
use execution::run_folder::RunError;
use recordings::LoadError;
use serde::Serialize;
use web::record::journal::{FORMAT, OLDEST_FORMAT};
use web::said::{Said, as_chain, chain, os};

/// Error of a journal or the recordings made of it.
#[derive(Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
pub enum RecordError {
    /// A file cannot be created, written, read, renamed or removed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        #[source]
        #[serde(serialize_with = "os")]
        source: io::Error,
    },
    /// Another session writes the journal.
    #[error("{} is being written by another session: end that first", path.display())]
    Busy {
        /// The journal.
        path: PathBuf,
    },
    /// The first line of a journal is incomplete: no sample was recorded.
    #[error("{} has no whole first line: no sample was recorded in it", path.display())]
    Empty {
        /// The journal.
        path: PathBuf,
    },
    /// The first line of a journal is damaged.
    #[error("{}: the line with the person's name is damaged; the file is left as it is", path.display())]
    Headless {
        /// The journal.
        path: PathBuf,
    },
    /// The journal is longer than any that this program records.
    #[error("{} has {found} bytes, expected at most {} MiB: it is left as it is, and no recording is made of it", path.display(), LARGEST >> 20)]
    #[serde(skip)]
    Large {
        /// The journal.
        path: PathBuf,
        /// Length in bytes.
        found: u64,
    },
    /// The journal has another format version.
    #[error("{}: format {found}, this program reads {OLDEST_FORMAT} to {FORMAT}: use the program that wrote it, version {version}", path.display())]
    #[serde(skip)]
    Format {
        /// The journal.
        path: PathBuf,
        /// Format version of the journal.
        found: u32,
        /// Version of the program that wrote it.
        version: String,
    },
    /// The disk took no more until the end of the session.
    #[error("{}: {source}; the last {seconds} s of the session are not in it and are lost", path.display())]
    Cut {
        /// The journal.
        path: PathBuf,
        /// Upper bound of the missing seconds.
        seconds: usize,
        /// Error of the operating system.
        #[source]
        #[serde(serialize_with = "os")]
        source: io::Error,
    },
    /// The journal was moved or deleted, and cannot be written anew.
    #[error(
        "{} was deleted, moved or replaced, and cannot be written anew: {source}; expected a folder {} that can be written",
        path.display(), folder(path).display()
    )]
    Gone {
        /// Former name of the journal.
        path: PathBuf,
        /// Reason why it cannot be written anew.
        #[source]
        #[serde(serialize_with = "os")]
        source: io::Error,
    },
    /// The journal was moved or deleted, and was written anew in another folder at the end.
    #[error(
        "{} was deleted, moved or replaced, and its folder cannot be written: all of the session is in {}; move that file into a folder {}",
        path.display(), found.display(), folder(path).display()
    )]
    Elsewhere {
        /// Former name of the journal.
        path: PathBuf,
        /// New name of the journal.
        found: PathBuf,
    },
    /// A recording cannot be written.
    #[error("{}: the recordings cannot be written ({}). Nothing is lost: free the disk, then start `myointent record` for this person again", journal.display(), chain(error))]
    Write {
        /// The journal.
        journal: PathBuf,
        /// Error of the write.
        #[serde(serialize_with = "as_chain")]
        error: RunError,
    },
    /// A recording's name is taken by another file.
    #[error("{} exists already and is left as it is: move it, then start `myointent record` for this person again", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The recording was written, but no command would read it.
    #[error("the recording is written and cannot be used; the journal is kept: {reason}")]
    Refused {
        /// Finding, with the file.
        reason: String,
    },
    /// The recording reads back differently.
    #[error("{} differs from the session when read back; the journal is kept", path.display())]
    Unlike {
        /// The recording.
        path: PathBuf,
    },
    /// The recording cannot be read back.
    #[error(transparent)]
    #[serde(skip)]
    Load(#[from] LoadError),
}

impl RecordError {
    /// The error in words.
    pub fn said(&self) -> Said {
        Said::of("journal", self)
    }

    /// Makes the error of an operation on a file.
    pub(super) fn io(path: &Path) -> impl Fn(io::Error) -> Self + Copy {
        |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}

/// Folder of a file.
pub(super) fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("."))
}
