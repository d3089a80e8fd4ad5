//! Faults of a file of recordings, in words: what was expected, what was found, what to do.

use super::excerpt::excerpt;
use crate::examiner::finding::Finding;
use crate::readers::table::separator::Separator;
use execution::file_kind::FileKind;

/// Fault of a file.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Fault {
    #[error("expected {expected} values as in the rows before, found {found}")]
    Fields { expected: usize, found: usize },
    #[error("expected a number in field {field}, found \"{}\"", excerpt(text))]
    Number { field: usize, text: String },
    #[error(
        "expected a count of the armband in field {field}, a whole number from -128 to 127, found {value}"
    )]
    Range { field: usize, value: f64 },
    #[error("expected a label of {expected}, found \"{}\"", excerpt(found))]
    Label {
        expected: &'static str,
        found: String,
    },
    #[error("expected a turn of 0..=7 and mirrored 0 or 1, found {turn} and {mirrored}")]
    Placement { turn: f64, mirrored: f64 },
    #[error("expected an array of {expected}, found {}", excerpt(found))]
    Array {
        expected: &'static str,
        found: String,
    },
    #[error("expected an npy file (format 1 to 3), but {}", excerpt(_0))]
    Npy(String),
    #[error("expected {expected} bytes, found {found}: the file is cut short or damaged")]
    Length { expected: u64, found: u64 },
    #[error("expected one label per sample, found {labels} labels for {samples} samples")]
    LabelCount { samples: usize, labels: usize },
    #[error("expected {} beside it, found no such file", excerpt(_0))]
    Partner(String),
    #[error("expected the folders and names of {set} as published, such as {example}")]
    Path {
        set: &'static str,
        example: &'static str,
    },
    #[error("expected {expected}, found {found}")]
    Kind {
        expected: &'static str,
        found: FileKind,
    },
    #[error("expected UTF-8 text, found bytes of another encoding: save the file as UTF-8")]
    Text,
    #[error(
        "expected a header with eight channels of one name, such as gt,emg_0 to emg_7, found {found} in \"{}\" \
         (separated by {separator}): name the eight columns of one armband so, and leave out those of other devices",
        excerpt(header)
    )]
    Channels {
        header: String,
        separator: Separator,
        found: String,
    },
    #[error(
        "expected eight channels a row, found {columns} columns (separated by {separator}) and no header that says \
         what they are: write one as first line, such as gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7"
    )]
    Headerless {
        columns: usize,
        separator: Separator,
    },
    #[error(
        "expected the header in the first line, found it in line {line}: remove the lines before it, or begin each with #"
    )]
    Title { line: usize },
    #[error(
        "expected rows of one kind, found {found} values here and {other} in line {line}: keep the rows of the EMG, with \
         one header, in a file of their own"
    )]
    Kinds {
        found: usize,
        other: usize,
        line: usize,
    },
    #[error(
        "expected a number in each field, found lists in brackets, \"{}\": write one sample a row, eight numbers and the \
         label",
        excerpt(_0)
    )]
    Lists(String),
    #[error(
        "expected rows of numbers separated by commas, semicolons, tabs or spaces, eight channels each, found other text"
    )]
    NoTable,
    #[error(
        "expected a header with one of the columns {expected}, found \"{}\"",
        excerpt(found)
    )]
    Column { expected: String, found: String },
    #[error(
        "expected column {column} of the description, found {}",
        excerpt(found)
    )]
    DescribedColumn { column: String, found: String },
    #[error(
        "expected a label that is listed in `labels` of the description, found \"{}\": add it to one of the lists, such as \
         unknown",
        excerpt(_0)
    )]
    Word(String),
    #[error("expected one row per sample, found none")]
    Empty,
    #[error("expected the set's JSON: {}", excerpt(_0))]
    Json(String),
    #[error("expected a MATLAB 5 file, but {}", excerpt(_0))]
    Mat(String),
    #[error(
        "the labels of this file are MATLAB objects, which only MATLAB reads: write each recording as \
         user10/training/001_fist.npy (docs/recordings.md)"
    )]
    Objects,
    #[error("expected {expected} gestures marked, found {found}")]
    Gestures { expected: usize, found: usize },
    #[error("{finding}; {}", finding.advice)]
    Refused { finding: Finding },
    #[error("expected a recording of at most {most} s, found one of {seconds:.0} s")]
    Duration { most: f64, seconds: f64 },
    #[error(
        "expected times that rise by at most {most} ms from row to row, found {from} and then {to}"
    )]
    Times { most: f64, from: f64, to: f64 },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_quotes_a_printable_excerpt_of_a_long_text() {
        let found = "\u{1b}[2J\u{9b}31m\u{202e}\rxxxx".to_owned() + &"x".repeat(10_000_000);
        let (text, expected) = (found.clone(), "(n, 8)");
        for fault in [
            Fault::Number { field: 1, text },
            Fault::Npy(found.clone()),
            Fault::Partner(found.clone()),
            Fault::Json(found.clone()),
            Fault::Array { expected, found },
        ] {
            let message = fault.to_string();
            assert!(message.len() < 400, "{} bytes", message.len());
            assert!(message.contains("xxxx"), "{message}");
            let raw = |c: char| c.is_control() || c == '\u{202e}';
            assert!(!message.contains(raw), "{message:?}");
        }
    }
}
