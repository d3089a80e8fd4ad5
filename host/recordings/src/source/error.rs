//! Error of downloading and unpacking recordings.

use std::fmt::Display;
use std::path::Path;

/// Error of downloading or unpacking recordings: what was expected, what was found, what to do.
#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub struct FetchError {
    words: String,
    /// Whether another attempt may succeed.
    pub(super) may_pass: bool,
}

impl FetchError {
    /// Error that every attempt would meet.
    pub(super) fn new(words: impl Into<String>) -> Self {
        Self {
            words: words.into(),
            may_pass: false,
        }
    }

    /// Error that another attempt may not meet.
    pub(super) fn passing(words: impl Into<String>) -> Self {
        Self {
            may_pass: true,
            ..Self::new(words)
        }
    }

    /// Answer of a server that is no file; `page` is the set's page for people.
    pub(super) fn status(url: &str, status: u16, page: &str) -> Self {
        match status {
            404 | 410 => Self::new(format!(
                "{url}: not found on the server (status {status}); the address may have changed, see {page}"
            )),
            _ => Self::passing(format!(
                "{url}: the server answers with status {status}; try again later"
            )),
        }
    }

    /// A refusal of the file system, or damage of an archive.
    pub(super) fn io(path: &Path, source: impl Display) -> Self {
        Self::new(format!("{}: {source}", path.display()))
    }
}
