//! Columns of a file, by what it says: names, numbers and words.

use std::collections::BTreeSet;
use std::path::Path;

use shared::units::CHANNELS;

use crate::examiner::clock::{rises, seconds_of};
use crate::examiner::finding::{Finding, Scale};
use crate::examiner::scale::ScaleDetector;
use crate::readers::error::{Fault, LoadError};
use crate::readers::npy::{self, Values};
use crate::readers::path::ending;
use crate::readers::table;
use crate::readers::table::columns::Columns as Named;
use crate::readers::table::head::Head;
use crate::readers::table::separator::Separator;
use execution::bounded_read;

/// Rows of a file that are looked at.
const EXAMINED: usize = 20_000;
/// Maximum number of different words of a column of labels.
const WORDS: usize = 64;

/// Kind of a file of samples.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ColumnKind {
    /// Ending of the file's name.
    ending: String,
    /// Separator of a text; none of an array.
    pub separator: Option<&'static str>,
    /// Number of columns; 0 where channels are known by their names.
    width: usize,
    /// Names of the columns, where channels are not known by them.
    names: Vec<String>,
}

impl ColumnKind {
    /// Kind of a file; none of one without eight columns of numbers, or that cannot be read.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = ending(path)
            .filter(|ending| matches!(ending.as_str(), "npy" | "csv" | "txt" | "tsv"))?;
        let table = DraftTable::of(path).ok()??;
        table.columns.first().filter(|column| !column.is_empty())?;
        let width = table.columns.len();
        let is_known = table.named.is_some();
        (is_known || table.numbers().len() >= CHANNELS).then(|| Self {
            ending,
            separator: table.separator,
            width: if is_known { 0 } else { width },
            names: if is_known { Vec::new() } else { table.names },
        })
    }
}

/// Beginning of a file by columns.
struct DraftTable {
    separator: Option<&'static str>,
    names: Vec<String>,
    /// Columns of the channels and of the label, where names tell.
    named: Option<Named>,
    columns: Vec<Vec<String>>,
}

impl DraftTable {
    /// Reads a file; none if it is no table.
    fn of(path: &Path) -> Result<Option<Self>, LoadError> {
        let bytes = bounded_read::read(path, bounded_read::RECORDING);
        let bytes = bytes.map_err(|source| LoadError::io(path, source))?;
        if let Ok(array) = npy::parse(&bytes) {
            let (&[_, width], Values::Numbers(values)) = (&array.shape[..], &array.values) else {
                return Ok(None);
            };
            let column = |at: usize| {
                let values = values.iter().skip(at).step_by(width.max(1));
                values.take(EXAMINED).map(f64::to_string).collect()
            };
            return Ok(Some(Self {
                separator: None,
                names: Vec::new(),
                named: None,
                columns: (0..width.min(bytes.len())).map(column).collect(),
            }));
        }
        let text = str::from_utf8(&bytes).unwrap_or_default();
        let text = text.trim_start_matches('\u{feff}');
        let Some(head) = Head::of(text, None) else {
            return Ok(None);
        };
        let named = match Named::of(text) {
            Ok(columns) => Some(columns).filter(|columns| !columns.names.is_empty()),
            // A person says which columns these are.
            Err(error)
                if matches!(
                    error.fault,
                    Fault::Channels { .. } | Fault::Headerless { .. }
                ) =>
            {
                None
            }
            Err(_) => return Ok(None),
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
        let mark = Separator::TEXTS
            .into_iter()
            .find(|(own, _)| *own == head.separator);
        let names = head.fields.iter().filter(|_| head.is_names);
        Ok(Some(Self {
            separator: mark.map(|(_, text)| text),
            names: names.map(|&name| name.to_owned()).collect(),
            named,
            columns,
        }))
    }

    /// Columns of numbers, but for those of times and counters.
    fn numbers(&self) -> Vec<usize> {
        let is_number = |text: &String| text.parse::<f64>().is_ok();
        let is_numeric = |at: &usize| {
            let column = &self.columns[*at];
            2 * column.iter().filter(|text| is_number(text)).count() > column.len()
        };
        let is_value = |at: &usize| is_numeric(at) && !self.is_clock(*at);
        (0..self.columns.len()).filter(is_value).collect()
    }

    /// Whether a column rises from row to row.
    fn is_clock(&self, at: usize) -> bool {
        let times: Option<Vec<f64>> = self.columns[at]
            .iter()
            .map(|text| seconds_of(text))
            .collect();
        times.is_some_and(|times| rises(&times))
    }
}

/// Columns of the files of a kind, by the first of them.
pub(super) struct Columns {
    /// Names in the header; none without one.
    pub names: Vec<String>,
    /// Columns of the channels; none where they are found by their names, or are all that there is.
    pub channels: Option<[usize; CHANNELS]>,
    /// Number of columns of numbers, if there are more than eight.
    pub more: Option<usize>,
    /// Column of times or a counter, unless it is found by its name.
    pub time: Option<usize>,
    pub label: Option<usize>,
    /// Counts for a value of 1, or what the examiner says of values that no scale makes counts.
    pub scale: Result<f64, Finding>,
}

impl Columns {
    /// Columns of a file; none if it has no eight columns of numbers.
    pub fn of(path: &Path) -> Result<Option<Self>, LoadError> {
        let Some(table) = DraftTable::of(path)? else {
            return Ok(None);
        };
        let numbers = table.numbers();
        let by_number = || numbers.get(..CHANNELS)?.try_into().ok();
        let named = table.named.as_ref();
        let Some(channels) = named.map(|own| own.channels).or_else(by_number) else {
            return Ok(None);
        };
        let is_plain_array = table.separator.is_none() && table.columns.len() == CHANNELS;
        let is_known = named.is_some() || is_plain_array;
        let is_words = |at: &usize| {
            let words: BTreeSet<&String> = table.columns[*at].iter().collect();
            !numbers.contains(at) && (2..=WORDS).contains(&words.len()) && !table.is_clock(*at)
        };
        let words = || (0..table.columns.len()).find(is_words);
        Ok(Some(Self {
            more: (!is_known && numbers.len() > CHANNELS).then_some(numbers.len()),
            channels: (!is_known).then_some(channels),
            time: (0..table.columns.len())
                .filter(|at| !is_known && !channels.contains(at))
                .find(|&at| table.is_clock(at)),
            label: named.map_or_else(words, |own| own.label),
            scale: scale(&table, &channels),
            names: table.names,
        }))
    }
}

/// Counts for a value of 1.
fn scale(table: &DraftTable, channels: &[usize; CHANNELS]) -> Result<f64, Finding> {
    let mut detector = ScaleDetector::default();
    for row in 0..table.columns[channels[0]].len() {
        let value = |at: &usize| table.columns[*at][row].parse::<f64>().unwrap_or(0.0);
        detector.push(&channels.iter().map(value).collect::<Vec<f64>>());
    }
    match detector.finish() {
        Ok(()) => Ok(1.0),
        Err(Finding::Scale {
            scale: Scale::Step { step, .. },
            ..
        }) if step < 1.0 => Ok((1.0 / step).round()),
        Err(Finding::Scale {
            scale: Scale::Step { step, .. },
            ..
        }) => Ok(1.0 / step),
        Err(finding) => Err(finding),
    }
}
