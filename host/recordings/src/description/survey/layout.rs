//! Layout of one file, as it looks: its columns, and whether it holds samples or labels.

use std::collections::BTreeSet;
use std::path::Path;

use shared::units::CHANNELS;

use crate::examiner::wide;
use crate::readers::error::{Damage, Fault, LoadError};
use crate::readers::npy::{self, Values};
use crate::readers::path::ending;
use crate::readers::table;
use crate::readers::table::columns::Columns;
use crate::readers::table::head::Head;
use crate::readers::table::separator::Separator;
use crate::readers::table::shape::Shape;
use execution::bounded_read;
use execution::file_kind::FileKind;

/// Rows of a file that are looked at.
const EXAMINED: usize = 20_000;
/// Maximum number of different labels; a column of more is measured values.
pub(super) const LABELS: usize = 64;

/// Columns of a file.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct Layout {
    /// Ending of the file's name.
    pub ending: String,
    /// Separator of a text; none of an array.
    pub separator: Option<&'static str>,
    /// Number of columns; 0 where they are known by their names and may differ from file to file.
    pub width: usize,
    /// Names in the header, if the columns are not known by them.
    pub names: Vec<String>,
}

/// Content of a file.
pub(super) enum Look {
    /// A table with eight columns or more.
    Samples(Layout),
    /// One label a row.
    Labels,
    /// Rows that no description makes samples, and why.
    Refused(LoadError),
    /// Anything else.
    Nothing,
}

/// Texts that separate columns, as a description has them.
const SEPARATORS: [(Separator, &str); 4] = [
    (Separator::Comma, ","),
    (Separator::Semicolon, ";"),
    (Separator::Tab, "\t"),
    (Separator::Space, " "),
];

/// Looks at a file.
///
/// # Errors
/// If it cannot be read.
pub(super) fn look(path: &Path) -> Result<Look, LoadError> {
    let is_read = |ending: &String| matches!(ending.as_str(), "npy" | "csv" | "txt" | "tsv");
    let Some(ending) = ending(path).filter(is_read) else {
        return Ok(Look::Nothing);
    };
    let bytes = read(path)?;
    let layout = |separator, width, names| {
        Look::Samples(Layout {
            ending: ending.clone(),
            separator,
            width,
            names,
        })
    };
    if FileKind::of(&bytes) == FileKind::Npy {
        return Ok(
            match npy::parse(&bytes).map(|array| (array.shape, array.values)) {
                Ok((shape, values)) if matches!(shape[..], [_] | [_, 1]) => labels(match values {
                    Values::Numbers(numbers) => numbers.iter().map(f64::to_string).collect(),
                    Values::Text(texts) => texts.into_iter().collect(),
                }),
                Ok((shape, Values::Numbers(_))) if matches!(shape[..], [_, width] if width >= CHANNELS) => {
                    layout(None, shape[1], Vec::new())
                }
                _ => Look::Nothing,
            },
        );
    }
    let Some(text) = text(&bytes) else {
        return Ok(Look::Nothing);
    };
    let Some(head) = Head::of(text, None) else {
        return Ok(Look::Nothing);
    };
    if let Err(finding) = wide::windows(text) {
        return Ok(Look::Refused(Damage::refused(finding).in_file(path)));
    }
    let mark = SEPARATORS.iter().find(|(own, _)| *own == head.separator);
    let mark = mark.map(|(_, text)| *text);
    let width = head.fields.len();
    Ok(match Columns::of(text) {
        Ok(columns) if !columns.names.is_empty() => layout(mark, 0, Vec::new()),
        Ok(_) => layout(mark, width, names(&head)),
        _ if width == 1 => {
            let rows = table::rows(text).map(|(_, row)| row.trim().to_owned());
            labels(rows.collect())
        }
        // Their columns are described by a person.
        Err(error)
            if matches!(
                error.fault,
                Fault::Channels { .. } | Fault::Headerless { .. }
            ) =>
        {
            let numbers = Shape::of(text).map_or(0, |shape| shape.numbers);
            if numbers >= CHANNELS {
                layout(mark, width, names(&head))
            } else {
                Look::Nothing
            }
        }
        Err(error) if error.is_meant => {
            Look::Refused(Damage::at_line(error.line, error.fault).in_file(path))
        }
        Err(_) => Look::Nothing,
    })
}

/// Names of the columns; none without a header.
fn names(head: &Head<'_>) -> Vec<String> {
    let names = head.fields.iter().filter(|_| head.is_names);
    names.map(|&name| name.to_owned()).collect()
}

/// A file of these labels.
fn labels(distinct: BTreeSet<String>) -> Look {
    if distinct.len() > LABELS {
        return Look::Nothing;
    }
    Look::Labels
}

fn read(path: &Path) -> Result<Vec<u8>, LoadError> {
    let bytes = bounded_read::read(path, bounded_read::RECORDING);
    bytes.map_err(|source| LoadError::io(path, source))
}

fn text(bytes: &[u8]) -> Option<&str> {
    let text = str::from_utf8(bytes).ok()?;
    Some(text.trim_start_matches('\u{feff}'))
}

/// Beginning of a file of samples, by columns.
pub(super) struct Beginning {
    /// Names in the header; none without one.
    pub names: Vec<String>,
    /// Columns of the channels and of the label, where names tell.
    pub by_name: Option<Columns>,
    /// Texts of each column.
    pub columns: Vec<Vec<String>>,
}

/// Beginning of a file; none if it is none of samples any more.
pub(super) fn beginning(path: &Path) -> Result<Option<Beginning>, LoadError> {
    let bytes = read(path)?;
    if let Ok(array) = npy::parse(&bytes) {
        let (&[_, width], Values::Numbers(values)) = (&array.shape[..], &array.values) else {
            return Ok(None);
        };
        let column = |at: usize| {
            let values = values.iter().skip(at).step_by(width.max(1));
            values.take(EXAMINED).map(f64::to_string).collect()
        };
        return Ok(Some(Beginning {
            names: Vec::new(),
            by_name: None,
            columns: (0..width).map(column).collect(),
        }));
    }
    let found = text(&bytes).and_then(|text| Some((text, Head::of(text, None)?)));
    let Some((text, head)) = found else {
        return Ok(None);
    };
    let first = head.line + usize::from(head.is_names);
    let rows = table::rows(text).skip_while(|(line, _)| *line < first);
    let mut columns = vec![Vec::new(); head.fields.len()];
    for (_, row) in rows.take(EXAMINED) {
        let fields = head.separator.fields(row);
        if fields.len() == columns.len() {
            for (column, field) in columns.iter_mut().zip(fields) {
                column.push(head.separator.number(field).into_owned());
            }
        }
    }
    let by_name = Columns::of(text)
        .ok()
        .filter(|columns| !columns.names.is_empty());
    Ok(Some(Beginning {
        names: names(&head),
        by_name,
        columns,
    }))
}
