//! What can be wrong with a file of recordings, and where.

use std::fmt;
use std::path::{Path, PathBuf};

use super::excerpt::{excerpt, printable};

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

/// What is wrong with a file.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Fault {
    /// A row with another number of fields.
    #[error("expected {expected} values, found {found}")]
    Fields {
        /// Values that this layout has in a row.
        expected: usize,
        /// Values in the row.
        found: usize,
    },
    /// A field that is no number.
    #[error("expected a number in field {field}, found \"{}\"", excerpt(text))]
    Number {
        /// Field of the row, 1 first.
        field: usize,
        /// Content of the field.
        text: String,
    },
    /// A sample outside the armband's range.
    #[error("expected a sample in -128..=127 in field {field}, found {value}")]
    Range {
        /// Field of the row, 1 first.
        field: usize,
        /// The value, in counts of the armband.
        value: f64,
    },
    /// A label that the data set does not have.
    #[error("expected a label of {expected}, found \"{}\"", excerpt(found))]
    Label {
        /// The labels of the set.
        expected: &'static str,
        /// The label found.
        found: String,
    },
    /// A placement of the armband that there is none of.
    #[error("expected a turn of 0..=7 and mirrored 0 or 1, found {turn} and {mirrored}")]
    Placement {
        /// Places that it is turned by.
        turn: f64,
        /// Whether it is on the other arm.
        mirrored: f64,
    },
    /// An array of another shape or element type.
    #[error("expected an array of {expected}, found {}", excerpt(found))]
    Array {
        /// Shape and type that this layout has.
        expected: &'static str,
        /// Shape and type of the file.
        found: String,
    },
    /// Bytes that are no npy file.
    #[error("expected an npy file (format 1 to 3), but {}", excerpt(_0))]
    Npy(String),
    /// Another number of bytes than the layout or the header requires.
    #[error("expected {expected} bytes, found {found}: the file is cut short or damaged")]
    Length {
        /// Bytes that should be there.
        expected: u64,
        /// Bytes that are there.
        found: u64,
    },
    /// Labels and samples of different number.
    #[error("expected one label per sample, found {labels} labels for {samples} samples")]
    LabelCount {
        /// Samples.
        samples: usize,
        /// Labels.
        labels: usize,
    },
    /// The other file of a pair is not there.
    #[error("expected {} beside it, found no such file", excerpt(_0))]
    Partner(String),
    /// A path that does not name the person.
    #[error("expected a path like {0}: the path names person and gesture")]
    Path(&'static str),
    /// Bytes that are no text.
    #[error("expected an npy file or UTF-8 text, found neither")]
    Text,
    /// A csv without the column that is looked for.
    #[error(
        "expected a header with one of the columns {expected}, found \"{}\"",
        excerpt(found)
    )]
    Column {
        /// Names that would do.
        expected: String,
        /// The first line.
        found: String,
    },
    /// Nothing in the file.
    #[error("expected one row per sample, found none")]
    Empty,
    /// Not the JSON that the set publishes.
    #[error("expected the set's JSON: {}", excerpt(_0))]
    Json(String),
    /// Text in another encoding.
    #[error("expected UTF-8 text, found UTF-16: save the file as UTF-8")]
    Utf16,
    /// Bytes that are no MATLAB file that is read here.
    #[error("expected a MATLAB 5 file, but {}", excerpt(_0))]
    Mat(String),
    /// Labels that only MATLAB can read.
    #[error(
        "the labels of this file are MATLAB objects, which only MATLAB reads: write each recording as \
         user10/training/001_fist.npy (docs/recordings.md)"
    )]
    Objects,
    /// Another number of labelled stretches than the layout has.
    #[error("expected {expected} gestures marked, found {found}")]
    Gestures {
        /// Gestures that this layout has in a file.
        expected: usize,
        /// Gestures in the file.
        found: usize,
    },
    /// Times that last too long.
    #[error("expected a recording of at most {most} s, found one of {seconds:.0} s")]
    Duration {
        /// Longest recording.
        most: f64,
        /// From the first row to this one.
        seconds: f64,
    },
    /// Times that go back or leave a gap.
    #[error(
        "expected times that rise by at most {most} ms from row to row, found {from} and then {to}"
    )]
    Times {
        /// Largest gap, in ms.
        most: f64,
        /// Time of the row before.
        from: f64,
        /// Time of the row.
        to: f64,
    },
}

/// A fault and its place, before the file is known.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Damage {
    pub place: Place,
    pub fault: Fault,
    /// The published copy has it too.
    pub as_published: bool,
}

impl Damage {
    pub const fn at(place: Place, fault: Fault) -> Self {
        Self {
            place,
            fault,
            as_published: false,
        }
    }

    pub const fn at_line(line: usize, fault: Fault) -> Self {
        Self::at(Place::Line(line), fault)
    }

    pub const fn at_byte(byte: u64, fault: Fault) -> Self {
        Self::at(Place::Byte(byte), fault)
    }

    pub const fn of_file(fault: Fault) -> Self {
        Self::at(Place::File, fault)
    }

    /// The error, now that the file is known.
    pub fn in_file(self, path: &Path) -> LoadError {
        LoadError::Damaged {
            path: path.to_owned(),
            place: self.place,
            fault: self.fault,
            as_published: self.as_published,
        }
    }
}

/// Why recordings could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file system refused, or the file is no regular one or too large.
    #[error("cannot read {}", path.display())]
    Io {
        /// File or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// No file in a format that is read here.
    #[error(
        "no recordings in {}: expected one of the published layouts (npy, csv, txt, dat, json or mat; see \
         `myointent data inspect --help`), or a single file of eight channels",
        path.display()
    )]
    NoRecordings {
        /// File or folder that was searched.
        path: PathBuf,
    },
    /// A damaged file.
    #[error(
        "{}, {place}: {fault}{}",
        path.display(),
        if *as_published { " (damaged as published)" } else { "" }
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: Place,
        /// What is wrong there.
        fault: Fault,
        /// The published copy has the same damage: downloading it again does not help.
        as_published: bool,
    },
}

impl LoadError {
    /// Whether the file was not even read.
    pub(crate) const fn is_refusal(&self) -> bool {
        matches!(self, Self::Io { .. })
    }

    /// The error with its causes, in one line.
    pub(crate) fn line(&self) -> String {
        let mut line = self.to_string();
        let mut cause = std::error::Error::source(self);
        while let Some(error) = cause {
            line += &format!(": {error}");
            cause = error.source();
        }
        printable(&line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_quotes_an_excerpt_of_a_long_text() {
        let found = "x".repeat(10_000_000);
        let text = found.clone();
        for fault in [
            Fault::Number { field: 1, text },
            Fault::Label {
                expected: "0, 1",
                found: found.clone(),
            },
            Fault::Array {
                expected: "(n, 8)",
                found: found.clone(),
            },
            Fault::Npy(found.clone()),
            Fault::Partner(found.clone()),
            Fault::Json(found.clone()),
            Fault::Column {
                expected: "gt".into(),
                found,
            },
        ] {
            let message = fault.to_string();
            assert!(message.len() < 400, "{} bytes", message.len());
            assert!(message.contains("xxxx"), "{message}");
        }
    }

    #[test]
    fn a_message_never_holds_a_control_character() {
        let found = "\u{1b}[2J\u{9b}31m\u{202e}\r".to_owned();
        for fault in [
            Fault::Npy(found.clone()),
            Fault::Array {
                expected: "(n, 8)",
                found: found.clone(),
            },
            Fault::Json(found),
        ] {
            let message = fault.to_string();
            let raw = |c: char| c.is_control() || c == '\u{202e}';
            assert!(!message.contains(raw), "{message:?}");
        }
    }
}
