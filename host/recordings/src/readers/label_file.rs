//! Labels from a file, one per sample, for `myointent score`.
//!
//! npy: one axis of class numbers or names, or (n, 9) in ReactEMG's layout. Text: one label per
//! line, or csv with a header that names the column, with any of the separators and in quotes or not; names of rows may stand
//! before the columns, with or without a header of their own. A label is a class number, a name
//! (`wave-in`), for any other movement -2, `other` or its name (`point`), or for no label -1, `unknown`, `none` or an empty field.

use std::path::Path;

use super::error::excerpt::excerpt;
use super::error::{self, Damage, EMPTY, LoadError};
use super::table;
use super::table::separator::{Separator, unquoted};
use crate::description::{Meanings, labels};
use crate::labels::motion::Motion;

/// Role of a file's labels.
///
/// A csv may have columns for both. Neither is ever read as the other: a prediction scored against itself is always
/// right.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Purpose {
    /// True labels.
    Truth,
    /// Predicted labels.
    Prediction,
    /// Predicted labels, each at the time when it is emitted.
    Emission,
}

impl Purpose {
    const ALL: [Self; 3] = [Self::Truth, Self::Prediction, Self::Emission];

    /// Columns of a csv that may hold the labels; the first of them that is found is read.
    const fn columns(self) -> &'static [&'static str] {
        match self {
            Self::Truth => &["gt", "truth", "label"],
            Self::Prediction => &["prediction", "predicted", "label"],
            Self::Emission => &["emitted"],
        }
    }

    /// Number of the column that a header names.
    fn column(self, header: &[&str]) -> Option<usize> {
        let named = |wanted: &&str| header.iter().position(|name| name == wanted);
        self.columns().iter().find_map(named)
    }
}

/// First row of a text, and how all rows are divided.
struct LabelHeader<'t> {
    separator: Separator,
    fields: Vec<&'t str>,
    /// Number of fields of the other rows.
    expected: usize,
}

impl<'t> LabelHeader<'t> {
    fn of(text: &'t str) -> Self {
        let mut rows = table::lines(text).map(|(_, row)| {
            let separator = Separator::of(row);
            (separator, separator.fields(row))
        });
        let (separator, fields) = rows.next().unwrap_or((Separator::Space, Vec::new()));
        let expected = fields.len().max(1);
        // Names of rows without a header of their own.
        let named = rows.next().filter(|(own, first)| {
            first.len() == expected + 1 && (expected == 1 || *own == separator)
        });
        Self {
            separator: named.as_ref().map_or(separator, |(own, _)| *own),
            fields,
            expected: named.map_or(expected, |(_, first)| first.len()),
        }
    }

    /// Number of a purpose's column in the other rows.
    fn column(&self, purpose: Purpose) -> Option<usize> {
        Some(purpose.column(&self.fields)? + (self.expected - self.fields.len()))
    }
}

/// Reads the labels of a file.
///
/// # Errors
/// [`LoadError::Io`], or [`LoadError::Damaged`] with the line or byte of the first invalid label.
pub fn read(path: &Path, purpose: Purpose) -> Result<Vec<Motion>, LoadError> {
    parse(&contents(path)?, purpose).map_err(|damage| damage.in_file(path))
}

/// Reads the labels of a file that need not have any of this purpose: none where it is no csv with such a column.
pub fn read_if_named(path: &Path, purpose: Purpose) -> Result<Option<Vec<Motion>>, LoadError> {
    let bytes = contents(path)?;
    let text = str::from_utf8(&bytes).unwrap_or_default();
    if LabelHeader::of(text).column(purpose).is_none() {
        return Ok(None);
    }
    let labels = parse(&bytes, purpose).map_err(|damage| damage.in_file(path))?;
    Ok(Some(labels))
}

/// Bytes of a file, without the byte order mark that some editors write.
fn contents(path: &Path) -> Result<Vec<u8>, LoadError> {
    let mut bytes = super::read(path)?;
    let mark = "\u{feff}".as_bytes();
    if bytes.starts_with(mark) {
        bytes.drain(..mark.len());
    }
    Ok(bytes)
}

/// Parses the bytes of a file of labels.
pub fn parse(bytes: &[u8], purpose: Purpose) -> Result<Vec<Motion>, Damage> {
    let text = str::from_utf8(bytes).unwrap_or_default();
    let header = LabelHeader::of(text);
    let mut purposes = Purpose::ALL.into_iter();
    if header.column(purpose).is_none()
        && (header.fields.len() > 1 || purposes.any(|other| header.column(other).is_some()))
    {
        let (_, found) = table::lines(text).next().unwrap_or_default();
        let fault = format!(
            "expected a header with one of the columns {}, found \"{}\"",
            purpose.columns().join(", "),
            excerpt(found)
        );
        return Err(Damage::at_line(1, fault));
    }
    let motions = labels(bytes, purpose)?.motions(&Meanings::default())?;
    let motions = motions.filter(|motions| !motions.is_empty());
    motions.ok_or_else(|| Damage::of_file(EMPTY))
}

/// Rows of a text of labels, each with its line: the column that a header names, else the whole of each.
pub(crate) fn rows(bytes: &[u8], purpose: Purpose) -> Result<Vec<(usize, &str)>, Damage> {
    let text = str::from_utf8(bytes).map_err(Damage::of_text)?;
    let header = LabelHeader::of(text);
    let Some(column) = header.column(purpose) else {
        let rows = table::lines(text).map(|(line, row)| (line, unquoted(row)));
        return Ok(rows.collect());
    };
    let field = |(line, row)| {
        // A line without a label has no field.
        let fields = header.separator.fields(row);
        let (expected, found) = (header.expected, fields.len().max(1));
        if found != expected {
            return Err(Damage::at_line(line, error::fields(expected, found)));
        }
        Ok((line, fields.get(column).copied().unwrap_or_default()))
    };
    table::lines(text).skip(1).map(field).collect()
}

/// Motion of a class number, 0 to 5, of -1 for unknown, or of -2 for other movement.
pub fn from_number(value: f64) -> Result<Motion, String> {
    let whole = (value.fract() == 0.0).then_some(value as i64);
    let motion = whole.and_then(Motion::from_number);
    motion.ok_or_else(|| {
        no_label(
            "-2 (other), -1 (unknown), 0, 1, 2, 3, 4, 5",
            &value.to_string(),
        )
    })
}

/// Motion of a name ([`Motion::from_name`]) or a number.
pub fn from_text(text: &str) -> Result<Motion, String> {
    let number = || from_number(text.parse().ok()?).ok();
    let motion = Motion::from_name(text).or_else(number);
    motion.ok_or_else(|| no_label("-2 to 5, an intent's name, other, or unknown", text))
}

fn no_label(expected: &str, found: &str) -> String {
    format!(
        "expected a label of {expected}, found \"{}\"",
        excerpt(found)
    )
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;
    use crate::readers::npy;
    use crate::recording::movement::MovementKind;

    const R: Motion = Motion::RELAX;
    const W: Motion = Motion::Intent(Intent::WaveIn);
    const NONE: Motion = Motion::Unknown;
    const OTHER: Motion = Motion::Other(MovementKind::Other);
    const POINT: Motion = Motion::Other(MovementKind::Point);
    const BOTH: &str = "prediction,label,gt\n0,1,3\n";

    #[test]
    fn labels_are_numbers_words_or_kinds_a_line_or_in_a_column_as_other_programs_write_it() {
        // With ' for ".
        for (text, expected) in [
            ("0\n3\n-1\nwave-in\nnone\n", &[R, W, NONE, W, NONE][..]),
            ("label\n0\n3.0\n", &[R, W]),
            ("-2\nother\npoint\nunknown\n", &[OTHER, OTHER, POINT, NONE]),
            ("sample,label,x\n0,relax,1\n1,,2\n", &[R, NONE]),
            ("'label'\n'relax'\n'wave-in'\n", &[R, W]),
            ("'sample','label'\n1,'relax'\n2,'3'\n", &[R, W]),
            // write.csv of R: names of rows under an empty header; write.table: under none.
            ("'','label'\n'1','relax'\n'2','wave-in'\n", &[R, W]),
            ("'','gt','label'\n'1',0,2\n'2',3,2\n", &[R, W]),
            ("'label'\n'1' 'relax'\n'2' 'wave-in'\n", &[R, W]),
            ("'t' 'label'\n'1' 0.5 0\n'2' 1 3\n", &[R, W]),
            ("'label','x'\n'1','relax','a, b'\n'2','3',''\n", &[R, W]),
            ("sample;label\r\n0,5;relax\r\n1;wave-in\r\n", &[R, W]),
            ("sample\tlabel\n0\trelax\n1\twave-in\n", &[R, W]),
            ("label\nrelax\n\n0\n", &[R, NONE, R]),
            (" 'relax' \n'wave-in'\n", &[R, W]),
            (BOTH, &[W]),
        ] {
            let text = text.replace('\'', "\"");
            let found = parse(text.as_bytes(), Purpose::Truth).unwrap();
            assert_eq!(found, expected, "{text}");
        }
        let array = npy::encode("|i1", &[3], &[0, 0xfe, 0xff]);
        let emitted = b"\"emitted\",\"label\"\n\"1\",\"relax\",\"close\"\n";
        for (bytes, purpose, expected) in [
            (&array[..], Purpose::Truth, vec![R, OTHER, NONE]),
            (BOTH.as_bytes(), Purpose::Prediction, vec![R]),
            (emitted, Purpose::Emission, vec![R]),
        ] {
            assert_eq!(parse(bytes, purpose), Ok(expected));
        }
    }

    #[test]
    fn what_is_no_label_of_the_purpose_is_refused_at_its_line() {
        use Purpose::{Prediction, Truth};
        const COLUMN: &str = "line 1: expected a header with one of the columns";
        const FIELDS: &str = "line 3: expected 2 values as in the rows before";
        const LABEL: &str = "line 2: expected a label";
        const EMPTY: &str = "expected one row per sample, found none";
        let empty = npy::encode("|i1", &[0], &[]);
        for (bytes, purpose, words) in [
            (&b"a,b\n0,0\n"[..], Truth, COLUMN),
            // Neither column is ever read as the other.
            (b"a,gt\n0,0\n", Prediction, COLUMN),
            (b"gt\n0\n", Prediction, COLUMN),
            (b"predicted\n0\n", Truth, COLUMN),
            (b"sample,label\n0,relax\n1\n", Truth, FIELDS),
            (b"\"label\"\n\"relax\"\n1 2\n", Truth, "expected 1 values"),
            (b"a,label\n1,2,3,0\n", Truth, "expected 2 values"),
            (b"0\n6\n", Truth, LABEL),
            (b"0\nfist\n", Truth, LABEL),
            (b"0\n0.5\n", Truth, LABEL),
            (b"0\n-3\n", Truth, LABEL),
            (b"0\n\xff\n", Truth, "byte 2: expected UTF-8 text"),
            (b"", Truth, EMPTY),
            (&empty, Truth, EMPTY),
        ] {
            let told = parse(bytes, purpose).unwrap_err().to_string();
            assert!(told.contains(words), "{words}: {told}");
        }
    }

    #[test]
    fn a_column_that_need_not_be_there_is_read_behind_a_byte_order_mark() {
        let read = |contents: &str| {
            let folder = crate::fixture::folder(&[("labels.csv", contents)]);
            read_if_named(&folder.path().join("labels.csv"), Purpose::Emission)
        };
        for (contents, expected) in [
            ("\u{feff}emitted,prediction\n0,3\n", Some(vec![R])),
            ("prediction\n3\n", None),
            ("3\n", None),
            ("", None),
        ] {
            assert_eq!(read(contents).unwrap(), expected);
        }
        assert!(read("emitted\n9\n").is_err());
    }
}
