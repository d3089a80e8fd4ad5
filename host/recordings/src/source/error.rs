//! Errors of downloading and unpacking recordings.

use std::io;
use std::path::{Path, PathBuf};

use execution::file_kind::FileKind;

/// Error of downloading or unpacking recordings.
#[derive(Debug, thiserror::Error)]
pub enum FetchError {
    #[error("cannot reach {host}: {reason}")]
    NoNetwork { host: String, reason: String },
    #[error(
        "{url}: not found on the server (status {status}); the address may have changed, see {page}"
    )]
    NotFound {
        url: String,
        status: u16,
        page: String,
    },
    #[error("{url}: the server answers with status {status}; try again later")]
    Status { url: String, status: u16 },
    #[error(
        "{url}: broke off after {received} bytes{of}: {reason}; the same command continues there"
    )]
    Broken {
        url: String,
        received: u64,
        of: String,
        reason: String,
    },
    #[error("{url}: sends more than {most} bytes; nothing of it is kept")]
    TooLong { url: String, most: u64 },
    #[error(
        "{file}: expected {expected}, found {found}: the download is damaged, or was changed after its checksum was published; it is removed"
    )]
    Checksum {
        file: String,
        expected: String,
        found: String,
    },
    #[error("{url}: expected a record of Zenodo: {reason}")]
    Record { url: String, reason: String },
    #[error("{archive}: expected a zip, tar or tar.gz archive, found {found}", archive = archive.display())]
    NoArchive { archive: PathBuf, found: FileKind },
    #[error(
        "the archive has a file named {0:?}, which leads out of its folder: nothing of it is unpacked"
    )]
    Escapes(String),
    #[error("the archive has {0:?} twice: nothing of it is unpacked")]
    Twice(String),
    #[error("the archive holds more than {most} {what}: nothing of it is unpacked")]
    TooLarge { most: u64, what: &'static str },
    #[error("{archive}: {source}", archive = archive.display())]
    Damaged { archive: PathBuf, source: io::Error },
    #[error(
        "expected recordings of {data_set} ({expected}), found {found}: is it the right archive? Nothing of it is kept"
    )]
    OtherContent {
        data_set: &'static str,
        expected: &'static str,
        found: String,
    },
    #[error("{} exists: remove it, or choose another folder with --to", _0.display())]
    Exists(PathBuf),
    #[error("{path}: {source}", path = path.display())]
    Io { path: PathBuf, source: io::Error },
}

impl FetchError {
    /// Answer of a server that is no file; `page` is the set's page for people.
    pub(super) fn status(url: &str, status: u16, page: &str) -> Self {
        let url = url.to_owned();
        match status {
            404 | 410 => Self::NotFound {
                url,
                status,
                page: page.to_owned(),
            },
            _ => Self::Status { url, status },
        }
    }

    /// Damage of an archive, by the error of reading it.
    pub(super) fn damaged(archive: &Path) -> impl Fn(io::Error) -> Self {
        |source| Self::Damaged {
            archive: archive.to_owned(),
            source,
        }
    }

    /// A refusal of the file system.
    pub(super) fn io(path: impl Into<PathBuf>, source: io::Error) -> Self {
        Self::Io {
            path: path.into(),
            source,
        }
    }
}
