//! Errors of reading recordings: the place of a fault, and its words, which say what was expected, what was found and what
//! to do.

pub(crate) mod excerpt;

use std::fmt;
use std::path::{Path, PathBuf};

use crate::examiner::finding::Finding;
use excerpt::excerpt;
use execution::file_kind::FileKind;
use execution::printable::printable;

/// Fault of a file without rows.
pub(crate) const EMPTY: &str = "expected one row per sample, found none";
/// Fault of a text in another encoding.
pub(crate) const NO_UTF_8: &str =
    "expected UTF-8 text, found bytes of another encoding: save the file as UTF-8";

/// Fault of a row with more or fewer values than those before.
pub(crate) fn fields(expected: usize, found: usize) -> String {
    format!("expected {expected} values as in the rows before, found {found}")
}

/// Fault of labels that are not one a sample.
pub(crate) fn label_count(samples: usize, labels: usize) -> String {
    format!("expected one label per sample, found {labels} labels for {samples} samples")
}

/// Fault of columns or axes.
pub(crate) fn array(expected: &str, found: &str) -> String {
    format!("expected an array of {expected}, found {}", excerpt(found))
}

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
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{place}: {fault}{}", if *as_published { " (damaged as published)" } else { "" })]
pub struct Damage {
    /// Place in the file.
    pub place: Place,
    /// Words of the fault.
    pub fault: String,
    /// Whether the published copy has the same damage, so that downloading it again does not help.
    pub as_published: bool,
}

impl Damage {
    pub(crate) fn at(place: Place, fault: impl Into<String>) -> Self {
        Self {
            place,
            fault: fault.into(),
            as_published: false,
        }
    }

    pub(crate) fn at_line(line: usize, fault: impl Into<String>) -> Self {
        Self::at(Place::Line(line), fault)
    }

    pub(crate) fn at_byte(byte: u64, fault: impl Into<String>) -> Self {
        Self::at(Place::Byte(byte), fault)
    }

    pub(crate) fn of_file(fault: impl Into<String>) -> Self {
        Self::at(Place::File, fault)
    }

    /// Damage of a file of another kind.
    pub(crate) fn of_kind(expected: &str, found: FileKind) -> Self {
        Self::of_file(format!("expected {expected}, found {found}"))
    }

    /// Damage of a text that is not UTF-8.
    pub(crate) fn of_text(error: std::str::Utf8Error) -> Self {
        Self::at_byte(error.valid_up_to() as u64, NO_UTF_8)
    }

    /// Error of this damage in a known file.
    pub(crate) fn in_file(self, path: &Path) -> LoadError {
        LoadError::Damaged {
            path: path.to_owned(),
            damage: self,
        }
    }
}

impl From<Finding> for Damage {
    /// Damage of a file without meaning.
    fn from(finding: Finding) -> Self {
        Self::of_file(format!("{finding}; {}", finding.advice))
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

    /// Error of a description, in a line or as a whole.
    pub(crate) fn description(
        path: &Path,
        line: Option<usize>,
        problem: impl Into<String>,
    ) -> Self {
        Self::Description {
            path: path.to_owned(),
            line,
            problem: problem.into(),
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
