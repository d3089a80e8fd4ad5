//! Columns of a file, by what it says: names, numbers and words.

use std::collections::BTreeSet;
use std::path::Path;

use shared::units::CHANNELS;

use super::quoted;
use crate::examiner::clock::{rises, seconds_of};
use crate::examiner::finding::Finding;
use crate::examiner::scale::ScaleDetector;
use crate::readers::npy::{self, Values};
use crate::readers::path::ending;
use crate::readers::read;
use crate::readers::table::columns::Columns as Named;
use crate::readers::table::head::Head;

/// Rows of a file that are looked at.
const EXAMINED: usize = 20_000;
/// Maximum number of different words of a column of labels.
const WORDS: usize = 64;

/// Columns of a file of samples, as a description has them.
pub(super) struct Columns {
    /// Ending of the file's name.
    pub ending: String,
    /// Lines on the channels and the times; empty where they are found by their names, or are all that there is.
    pub channels: String,
    /// Column of the labels, and whether it is ReactEMG's.
    pub label: Option<(String, bool)>,
    /// Counts for a value of 1, or what the examiner says of values that no scale makes counts.
    pub scale: Result<f64, Finding>,
}

impl Columns {
    /// Columns of a file; none of one without eight columns of numbers, or that cannot be read.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = ending(path)
            .filter(|ending| matches!(ending.as_str(), "npy" | "csv" | "txt" | "tsv"))?;
        let bytes = read(path).ok()?;
        let table = match npy::parse(&bytes) {
            Ok(array) => Table::of_array(&array)?,
            Err(_) => Table::of_text(str::from_utf8(&bytes).ok()?)?,
        };
        table.columns.first().filter(|column| !column.is_empty())?;
        let numbers: Vec<usize> = (0..table.columns.len())
            .filter(|&at| table.is_numeric(at) && !table.is_clock(at))
            .collect();
        let named = table.named.as_ref();
        let channels = match named {
            Some(named) => named.channels,
            None => numbers.get(..CHANNELS)?.try_into().ok()?,
        };
        let is_plain_array = table.separator.is_none() && table.columns.len() == CHANNELS;
        let mut lines = String::new();
        if named.is_none() && !is_plain_array {
            if let Some(separator) = table.separator {
                let header = !table.names.is_empty();
                lines = format!("separator = {}\nheader = {header}\n", quoted(separator));
            }
            if numbers.len() > CHANNELS {
                lines += "# Channels are the first eight columns of numbers: check.\n";
            }
            let channels = channels.map(|at| table.column(at)).join(", ");
            lines += &format!("channels = [{channels}]\n");
            if let Some(time) = (0..table.columns.len()).find(|&at| table.is_clock(at)) {
                lines += &format!("time = {}\n", table.column(time));
            }
        }
        let is_words = |at: &usize| {
            let words: BTreeSet<&String> = table.columns[*at].iter().collect();
            !numbers.contains(at) && (2..=WORDS).contains(&words.len()) && !table.is_clock(*at)
        };
        let words = || (0..table.columns.len()).find(is_words);
        let label = named.map_or_else(words, |own| own.label);
        let is_gt = |at: usize| table.names.get(at).is_some_and(|name| name == "gt");
        Some(Self {
            ending,
            channels: lines,
            label: label.map(|at| (table.column(at), is_gt(at))),
            scale: table.scale(channels),
        })
    }
}

/// Beginning of a file by columns.
struct Table {
    /// Separator of a text; none of an array.
    separator: Option<&'static str>,
    names: Vec<String>,
    /// Columns of the channels and of the label, where names tell.
    named: Option<Named>,
    columns: Vec<Vec<String>>,
}

impl Table {
    fn of_array(array: &npy::Array) -> Option<Self> {
        let (&[_, width], Values::Numbers(values)) = (&array.shape[..], &array.values) else {
            return None;
        };
        let column = |at: usize| {
            let values = values.iter().skip(at).step_by(width);
            values.take(EXAMINED).map(f64::to_string).collect()
        };
        Some(Self {
            separator: None,
            names: Vec::new(),
            named: None,
            // An array without rows may claim any number of columns.
            columns: (0..width.min(values.len())).map(column).collect(),
        })
    }

    fn of_text(text: &str) -> Option<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let head = Head::of(text, None)?;
        let named = match Named::of(text) {
            Ok(columns) => Some(columns).filter(|columns| !columns.names.is_empty()),
            // A person says which columns these are.
            Err(error) if error.has_columns => None,
            Err(_) => return None,
        };
        let all = Named::of_head(&head, head.is_names);
        let mut columns = vec![Vec::new(); all.count];
        for (_, fields) in all.rows(text).take(EXAMINED).flatten() {
            for (column, field) in columns.iter_mut().zip(fields) {
                column.push(all.separator.number(field).into_owned());
            }
        }
        Some(Self {
            separator: Some(all.separator.name()),
            names: all.names,
            named,
            columns,
        })
    }

    /// A column by its name, or by its number if names are missing or not different.
    fn column(&self, at: usize) -> String {
        let different: BTreeSet<&String> = self.names.iter().collect();
        match self.names.get(at) {
            Some(name) if different.len() == self.names.len() => quoted(name.trim()),
            _ => (at + 1).to_string(),
        }
    }

    fn is_numeric(&self, at: usize) -> bool {
        let column = &self.columns[at];
        let numbers = column.iter().filter(|text| text.parse::<f64>().is_ok());
        2 * numbers.count() > column.len()
    }

    /// Whether a column rises from row to row, as times and counters do.
    fn is_clock(&self, at: usize) -> bool {
        let texts = self.columns[at].iter();
        let times: Option<Vec<f64>> = texts.map(|text| seconds_of(text)).collect();
        times.is_some_and(|times| rises(&times))
    }

    /// Counts for a value of 1.
    fn scale(&self, channels: [usize; CHANNELS]) -> Result<f64, Finding> {
        let mut detector = ScaleDetector::default();
        for row in 0..self.columns[channels[0]].len() {
            let value = |at: usize| self.columns[at][row].parse::<f64>().unwrap_or(0.0);
            detector.push(&channels.map(value));
        }
        match detector.scale().step() {
            Some(step) if step < 1.0 => Ok((1.0 / step).round()),
            Some(step) => Ok(1.0 / step),
            None => detector.finish().map(|()| 1.0),
        }
    }
}
