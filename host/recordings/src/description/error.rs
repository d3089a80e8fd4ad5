//! Errors of a description: file, line or field, expected, found, what to do.

use std::fmt;
use std::path::PathBuf;

use execution::printable::printable;

/// Reason why a description is refused.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum Problem {
    #[error("{}", printable(_0))]
    Syntax(String),
    #[error("expected one of `{0}` and `{1}`, found both: remove one")]
    Both(&'static str, &'static str),
    #[error("`{field}` needs {needs}, found none: {advice}")]
    Needs {
        field: &'static str,
        needs: &'static str,
        advice: &'static str,
    },
    #[error(
        "expected in `label_files` fields that `files` has, found {{{0}}}: a file of labels is named after its recording"
    )]
    Beyond(&'static str),
    #[error("expected `folder` to be a folder, found none at {}", _0.display())]
    Folder(PathBuf),
}

/// Error of a description.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DescriptionError {
    /// The file.
    pub path: PathBuf,
    /// Line of the fault, 1 first; none where it is not in one line.
    pub line: Option<usize>,
    /// The reason.
    pub problem: Problem,
}

impl std::error::Error for DescriptionError {}

impl fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}", self.problem)
    }
}
