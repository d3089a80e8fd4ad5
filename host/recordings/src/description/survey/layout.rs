//! Layout of one file, as it looks: its columns, and whether it holds samples or labels.

use std::collections::BTreeSet;
use std::path::Path;

use shared::units::CHANNELS;

use crate::readers::error::LoadError;
use crate::readers::npy::{self, Values};
use crate::readers::path::ending;
use crate::readers::table;
use crate::readers::table::columns::Columns;
use crate::readers::table::separator::Separator;
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
    let Some((separator, names, width)) = header(text) else {
        return Ok(Look::Nothing);
    };
    let by_name = Columns::of(text).is_ok_and(|columns| !columns.names.is_empty());
    let mark = SEPARATORS.iter().find(|(own, _)| *own == separator);
    let mark = mark.map(|(_, text)| *text);
    Ok(match width {
        _ if by_name => layout(mark, 0, Vec::new()),
        CHANNELS.. if has_channels(text, separator) => layout(mark, width, names),
        1 => labels(
            table::rows(text)
                .map(|(_, row)| row.trim().to_owned())
                .collect(),
        ),
        _ => Look::Nothing,
    })
}

/// Whether most of the first rows have eight numbers or more; labels may be words.
fn has_channels(text: &str, separator: Separator) -> bool {
    const FIRST: usize = 20;
    let rows = table::rows(text)
        .map(|(_, row)| row)
        .filter(|row| !table::is_note(row));
    let rows: Vec<&str> = rows.take(FIRST).collect();
    let is_number = |field: &&str| separator.number(field).parse::<f64>().is_ok();
    let numbers = |row: &&&str| {
        separator
            .fields(row)
            .iter()
            .filter(|field| is_number(field))
            .count()
    };
    2 * rows.iter().filter(|row| numbers(row) >= CHANNELS).count() > rows.len()
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

/// Separator, names (none without a header) and number of columns.
fn header(text: &str) -> Option<(Separator, Vec<String>, usize)> {
    let mut rows = table::rows(text).map(|(_, row)| row);
    let first = rows.find(|row| !table::is_note(row))?;
    let separator = Separator::of(first);
    let fields = separator.fields(first);
    let is_number = |field: &&str| separator.number(field).parse::<f64>().is_ok();
    let names = if fields.iter().all(is_number) {
        Vec::new()
    } else {
        fields.iter().map(|&name| name.to_owned()).collect()
    };
    Some((separator, names, fields.len()))
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
    let found = text(&bytes).and_then(|text| Some((text, header(text)?)));
    let Some((text, (separator, names, width))) = found else {
        return Ok(None);
    };
    let rows = table::rows(text).map(|(_, row)| row);
    let rows = rows
        .skip_while(|row| table::is_note(row))
        .skip(usize::from(!names.is_empty()));
    let mut columns = vec![Vec::new(); width];
    for row in rows.take(EXAMINED) {
        let fields = separator.fields(row);
        if fields.len() == width {
            for (column, field) in columns.iter_mut().zip(fields) {
                column.push(separator.number(field).into_owned());
            }
        }
    }
    let by_name = Columns::of(text)
        .ok()
        .filter(|columns| !columns.names.is_empty());
    Ok(Some(Beginning {
        names,
        by_name,
        columns,
    }))
}
