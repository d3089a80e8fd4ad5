//! Errors of downloading and unpacking recordings.

use std::io;
use std::path::PathBuf;

use super::checksum::Checksum;
use execution::file_kind::FileKind;

/// Error of downloading or unpacking recordings.
#[derive(Debug, thiserror::Error)]
pub enum FetchError {
    /// The server cannot be reached.
    #[error("cannot reach {host}: {reason}")]
    NoNetwork {
        /// The server.
        host: String,
        /// Reason that the system gave.
        reason: String,
    },
    /// The server has no such file.
    #[error(
        "{url}: not found on the server (status {status}); the address may have changed, see {page}"
    )]
    NotFound {
        /// Address.
        url: String,
        /// HTTP status.
        status: u16,
        /// Page of the data set.
        page: String,
    },
    /// The server refuses, or is broken.
    #[error("{url}: the server answers with status {status}; try again later")]
    Status {
        /// Address.
        url: String,
        /// HTTP status.
        status: u16,
    },
    /// The connection broke again and again.
    #[error(
        "{url}: broke off after {received} bytes{of}: {reason}; the same command continues there"
    )]
    Broken {
        /// Address.
        url: String,
        /// Bytes that are kept.
        received: u64,
        /// The whole length, in words, if it is known.
        of: String,
        /// Reason of the last break.
        reason: String,
    },
    /// The server sends more than it announced, or than any data set has.
    #[error("{url}: sends more than {most} bytes; nothing of it is kept")]
    TooLong {
        /// Address.
        url: String,
        /// Bound in bytes.
        most: u64,
    },
    /// The file is not the published one.
    #[error(
        "{file}: expected {expected}, found {found}: the download is damaged, or was changed after its checksum was published; it is removed"
    )]
    Checksum {
        /// File.
        file: String,
        /// Published checksum.
        expected: Checksum,
        /// Computed checksum.
        found: Checksum,
    },
    /// The record of Zenodo is not what its interface promises.
    #[error("{url}: expected a record of Zenodo: {reason}")]
    Record {
        /// Address.
        url: String,
        /// Reason.
        reason: String,
    },
    /// The file is neither kind of archive.
    #[error("{archive}: expected a zip, tar or tar.gz archive, found {found}", archive = archive.display())]
    NoArchive {
        /// The file.
        archive: PathBuf,
        /// Kind of the file.
        found: FileKind,
    },
    /// A name leads out of the folder, or is one that no file system takes.
    #[error(
        "the archive has a file named {name:?}, which leads out of its folder: nothing of it is unpacked"
    )]
    Escapes {
        /// The name.
        name: String,
    },
    /// Two files have one name.
    #[error("the archive has {name:?} twice: nothing of it is unpacked")]
    Twice {
        /// The name.
        name: String,
    },
    /// The archive holds more than any data set has, or than such an archive can honestly hold.
    #[error("the archive holds more than {most} {what}: nothing of it is unpacked")]
    TooLarge {
        /// Bound.
        most: u64,
        /// Unit of the bound.
        what: &'static str,
    },
    /// The archive is damaged, encrypted, or of an unknown kind of compression.
    #[error("{archive}: {source}", archive = archive.display())]
    Damaged {
        /// The file.
        archive: PathBuf,
        /// Error of the library.
        source: io::Error,
    },
    /// The archive holds other files.
    #[error(
        "expected recordings of {data_set} ({expected}), found {found}: is it the right archive? Nothing of it is kept"
    )]
    OtherContent {
        /// The data set that was asked for.
        data_set: &'static str,
        /// Properties that its files are recognised by.
        expected: &'static str,
        /// Description of what there is instead.
        found: String,
    },
    /// The folder of the data set exists.
    #[error("{path} exists: remove it, or choose another folder with --to", path = path.display())]
    Exists {
        /// Folder of the data set.
        path: PathBuf,
    },
    /// The file system refuses.
    #[error("{path}: {source}", path = path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// Reason.
        source: io::Error,
    },
}

impl FetchError {
    /// A refusal of the file system.
    pub(super) fn io(path: impl Into<PathBuf>, source: io::Error) -> Self {
        Self::Io {
            path: path.into(),
            source,
        }
    }
}
