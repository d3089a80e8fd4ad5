//! Errors of reading recordings, and the place of a fault.

pub(crate) mod excerpt;
mod fault;

use std::fmt;
use std::path::{Path, PathBuf};

use crate::examiner::finding::Finding;
use execution::file_kind::FileKind;
use execution::printable::printable;
pub use fault::Fault;

/// Place of a fault in its file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Place {
    /// Line of a text file, 1 first.
    Line(usize),
    /// Byte of a binary file, 0 first.
    Byte(u64),
    /// The file as a whole.
    File,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::File => f.write_str("whole file"),
        }
    }
}

/// Fault of a file, and its place in the file.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[error("{place}: {fault}{}", if *as_published { " (damaged as published)" } else { "" })]
pub struct Damage {
    /// Place in the file.
    pub place: Place,
    /// Fault at that place.
    pub fault: Fault,
    /// Whether the published copy has the same damage, so that downloading it again does not help.
    pub as_published: bool,
}

impl Damage {
    pub(crate) const fn at(place: Place, fault: Fault) -> Self {
        Self {
            place,
            fault,
            as_published: false,
        }
    }

    pub(crate) const fn at_line(line: usize, fault: Fault) -> Self {
        Self::at(Place::Line(line), fault)
    }

    pub(crate) const fn at_byte(byte: u64, fault: Fault) -> Self {
        Self::at(Place::Byte(byte), fault)
    }

    pub(crate) const fn of_file(fault: Fault) -> Self {
        Self::at(Place::File, fault)
    }

    /// Damage of a file of another kind.
    pub(crate) const fn of_kind(expected: &'static str, found: FileKind) -> Self {
        Self::of_file(Fault::Kind { expected, found })
    }

    /// Damage of a file without meaning.
    pub(crate) fn refused(finding: Finding) -> Self {
        Self::of_file(Fault::Refused { finding })
    }

    /// Error of this damage in a known file.
    pub(crate) fn in_file(self, path: &Path) -> LoadError {
        LoadError::Damaged {
            path: path.to_owned(),
            damage: self,
        }
    }
}

/// Error of loading recordings.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum LoadError {
    #[error("cannot read {}", path.display())]
    Io {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "no recordings in {}: expected one of the published layouts, or tables with eight channels (see \
         `myointent data inspect --help`), found {found}; `myointent data describe` writes a description of other layouts",
        path.display()
    )]
    NoRecordings { path: PathBuf, found: String },
    #[error("no recording is left in {}: {skipped} files are left out; the first: {first}", path.display())]
    NoneLeft {
        path: PathBuf,
        skipped: usize,
        first: String,
    },
    #[error("{}{}: {}", path.display(), line.map_or(String::new(), |line| format!(", line {line}")), printable(problem))]
    Description {
        path: PathBuf,
        /// Line of the fault, 1 first; none where it is not in one line.
        line: Option<usize>,
        problem: String,
    },
    #[error("{}, {damage}", path.display())]
    Damaged { path: PathBuf, damage: Damage },
}

impl LoadError {
    /// Error of the file system at a path.
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// Whether the file was not even read.
    pub(crate) const fn is_refusal(&self) -> bool {
        matches!(self, Self::Io { .. })
    }

    /// The error with its causes, in one line.
    pub fn line(&self) -> String {
        in_one_line(self)
    }
}

/// An error with its causes, in one line that a terminal can show.
pub fn in_one_line(error: &dyn std::error::Error) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        line += &format!(": {error}");
        cause = error.source();
    }
    printable(&line)
}
