//! Rows of a file as a description has them: samples, words of labels, a clock.

use std::path::PathBuf;

use shared::units::{CHANNELS, Sample};

use super::Description;
use super::values::Column;
use super::words::{Labels as Meanings, Words};
use crate::examiner::wide;
use crate::labels::motion::Motion;
use crate::readers::error::{Damage, Fault, Place};
use crate::readers::label_file::{self, Purpose};
use crate::readers::npy::{self, Array, Values};
use crate::readers::table::auxiliary::{AuxiliaryColumns, unnamed};
use crate::readers::table::columns::Columns;
use crate::readers::table::head::Head;
use crate::readers::table::separator::Separator;
use crate::readers::table::{self, Samples};
use execution::file_kind::FileKind;

/// Labels of the rows, and where they stand.
#[derive(Default)]
pub(crate) struct Labels {
    pub(super) words: Option<Words>,
    pub(super) at: At,
}

/// Places of rows in their file.
#[derive(Clone, Default)]
pub(crate) enum At {
    /// A name.
    #[default]
    File,
    /// Line of each.
    Lines(Vec<usize>),
    /// Bytes from this one on, so many a row.
    Bytes(u64, u64),
}

impl At {
    const fn of(array: &Array) -> Self {
        let start = array.byte_of_row(0);
        Self::Bytes(start, array.byte_of_row(1) - start)
    }

    pub fn place(&self, row: usize) -> Place {
        match self {
            Self::File => Place::File,
            Self::Lines(lines) => Place::Line(lines[row]),
            Self::Bytes(start, bytes) => Place::Byte(start + row as u64 * bytes),
        }
    }
}

/// Rows of a file: samples, words of labels, and what stands beside them.
pub(super) struct Rows {
    pub samples: Vec<Sample>,
    pub labels: Labels,
    /// File of the labels, if it is another.
    pub labels_file: Option<PathBuf>,
    pub auxiliary: AuxiliaryColumns,
}

impl Rows {
    /// Samples with words of labels, and their places in the file.
    pub fn of(samples: Vec<Sample>, words: Option<Words>, at: At) -> Self {
        Self {
            samples,
            labels: Labels { words, at },
            labels_file: None,
            auxiliary: AuxiliaryColumns::default(),
        }
    }
}

impl Description {
    /// Rows of a file's bytes.
    pub(super) fn rows(&self, bytes: &[u8]) -> Result<Rows, Damage> {
        match FileKind::of(bytes) {
            FileKind::Npy => self.array(&npy::parse(bytes)?),
            FileKind::Table | FileKind::Text => match str::from_utf8(bytes) {
                Ok(text) => self.table(text.trim_start_matches('\u{feff}')),
                Err(error) => Err(Damage::at_byte(error.valid_up_to() as u64, Fault::Text)),
            },
            FileKind::Empty => Err(Damage::of_file(Fault::Empty)),
            found => {
                let expected = "a table of text or an npy array, as a description has them";
                Err(Damage::of_kind(expected, found))
            }
        }
    }

    fn table<'t>(&self, text: &'t str) -> Result<Rows, Damage> {
        wide::windows(text).map_err(Damage::refused)?;
        let columns = self.columns(text)?;
        let word = |fields: &[&'t str]| columns.label.map_or("", |at| fields[at]);
        self.rows_of(text, &columns, |_, fields| Ok(word(fields)))
    }

    /// Rows of a table of these columns; `word` gives the word of a row's label.
    pub(super) fn rows_of<'t>(
        &self,
        text: &'t str,
        columns: &Columns,
        mut word: impl FnMut(usize, &[&'t str]) -> Result<&'t str, Damage>,
    ) -> Result<Rows, Damage> {
        let at = |time| position(time, &columns.names, columns.count, columns.first_line);
        let time = self.time.as_ref().map(at).transpose()?;
        let mut auxiliary = AuxiliaryColumns::find(columns, time);
        let (mut samples, mut words) =
            (Samples::default(), columns.label.map(|_| Words::default()));
        let mut lines = Vec::new();
        for row in columns.rows(text) {
            let (line, fields) = row?;
            let at_line = |fault| Damage::at_line(line, fault);
            let mut counts = [0.0; CHANNELS];
            for (count, &at) in counts.iter_mut().zip(&columns.channels) {
                let text = columns.separator.number(fields[at]);
                *count = table::number(line, at + 1, &text)? * self.scale;
            }
            samples.push(&counts, columns.channels[0] + 1, at_line);
            auxiliary.push(columns.separator, &fields);
            lines.push(line);
            let word = word(line, &fields)?;
            if let Some(words) = &mut words {
                words.push(word);
            }
        }
        let rows = Rows::of(samples.finish()?, words, At::Lines(lines));
        Ok(Rows { auxiliary, ..rows })
    }

    /// Columns of a table.
    pub(super) fn columns(&self, text: &str) -> Result<Columns, Damage> {
        let mut columns = match &self.channels {
            None => Columns::of(text).map_err(|error| Damage::at_line(error.line, error.fault))?,
            Some(channels) => {
                let head = Head::of(text, self.separator).ok_or(Damage::of_file(Fault::Empty))?;
                let is_named = |column: &Column| matches!(column, Column::Named(_));
                let is_names = head.is_names || channels.0.iter().any(is_named);
                let header = self.header.unwrap_or(is_names);
                let mut columns = Columns::of_head(&head, header);
                for (found, column) in columns.channels.iter_mut().zip(&channels.0) {
                    *found = position(column, &columns.names, columns.count, head.line)?;
                }
                columns
            }
        };
        let label = self.label.as_ref();
        let at = |label| position(label, &columns.names, columns.count, columns.first_line);
        columns.label = label.map(at).transpose()?;
        Ok(columns)
    }

    pub(super) fn array(&self, array: &Array) -> Result<Rows, Damage> {
        let Values::Numbers(values) = &array.values else {
            return Err(wrong_array(array));
        };
        let &[_, width] = &array.shape[..] else {
            return Err(wrong_array(array));
        };
        let at = |column: &Column| position(column, &[], width, 1).map_err(|_| wrong_array(array));
        let mut channels: [usize; CHANNELS] = std::array::from_fn(|channel| channel);
        match &self.channels {
            Some(described) => {
                for (channel, column) in channels.iter_mut().zip(&described.0) {
                    *channel = at(column)?;
                }
            }
            None if width == CHANNELS => {}
            None => return Err(wrong_array(array)),
        }
        let [label, time] =
            [&self.label, &self.time].map(|column| column.as_ref().map(at).transpose());
        let (label, time) = (label?, time?);
        let columns = Columns {
            separator: Separator::Comma,
            names: Vec::new(),
            count: width,
            channels,
            label,
            first_line: 1,
        };
        let mut auxiliary = AuxiliaryColumns::find(&columns, time);
        let (mut samples, mut words) = (Samples::default(), label.map(|_| Words::default()));
        for (row, values) in values.chunks_exact(width.max(1)).enumerate() {
            let counts = channels.map(|channel: usize| values[channel] * self.scale);
            samples.push(&counts, channels[0] + 1, |fault| {
                Damage::at_byte(array.byte_of_row(row), fault)
            });
            if let Some((words, at)) = words.as_mut().zip(label) {
                words.push(&values[at].to_string());
            }
            auxiliary.push_values(values);
        }
        let rows = Rows::of(samples.finish()?, words, At::of(array));
        Ok(Rows { auxiliary, ..rows })
    }
}

fn wrong_array(array: &Array) -> Damage {
    Damage::of_file(Fault::Array {
        expected: "numbers, (n, 8), or (n, more) and the numbers of the columns in the description",
        found: array.describe(),
    })
}

fn position(column: &Column, names: &[String], count: usize, line: usize) -> Result<usize, Damage> {
    let found = match column {
        Column::At(at) => Some(*at).filter(|at| *at < count),
        Column::Named(wanted) => names.iter().position(|name| name == wanted),
    };
    found.ok_or_else(|| {
        let column = match column {
            Column::At(at) => unnamed(*at),
            Column::Named(name) => format!("\"{name}\""),
        };
        let found = if names.is_empty() {
            format!("{count} columns without names")
        } else {
            names.join(", ")
        };
        Damage::at_line(line, Fault::DescribedColumn { column, found })
    })
}

/// Words of a file with a label a sample: an npy array, whose first column is read, or text.
pub(crate) fn labels(bytes: &[u8], purpose: Purpose) -> Result<Labels, Damage> {
    let mut words = Words::default();
    let at = if FileKind::of(bytes) == FileKind::Npy {
        let array = npy::parse(bytes)?;
        let columns = match array.shape[..] {
            [_] => 1,
            [_, columns @ (1 | 9)] => columns,
            _ => {
                let expected = "labels, (n) or (n, 9)";
                let found = array.describe();
                return Err(Damage::of_file(Fault::Array { expected, found }));
            }
        };
        match &array.values {
            Values::Numbers(values) => {
                let values = values.iter().step_by(columns);
                values.for_each(|value| words.push(&value.to_string()));
            }
            Values::Text(texts) => {
                let texts = texts.iter().step_by(columns);
                texts.for_each(|text| words.push(text));
            }
        }
        At::of(&array)
    } else {
        let rows = label_file::rows(bytes, purpose)?;
        rows.iter().for_each(|(_, word)| words.push(word));
        At::Lines(rows.into_iter().map(|(line, _)| line).collect())
    };
    let words = Some(words);
    Ok(Labels { words, at })
}

impl Labels {
    /// The labels if there is one for each sample.
    pub(super) fn of_each(self, samples: usize) -> Result<Self, Damage> {
        let labels = self.words.as_ref().map_or(0, |words| words.at.len());
        if labels == samples {
            return Ok(self);
        }
        Err(Damage::of_file(Fault::LabelCount { samples, labels }))
    }

    /// Motion of each word.
    ///
    /// # Errors
    /// A word without a meaning, at its place.
    pub fn motions(&self, meanings: &Meanings) -> Result<Option<Vec<Motion>>, Damage> {
        let Some(words) = &self.words else {
            return Ok(None);
        };
        let mut motions = Vec::new();
        for (word, row) in words.distinct() {
            let motion = meanings.meaning(word);
            motions.push(motion.map_err(|fault| Damage::at(self.at.place(*row), fault))?);
        }
        Ok(Some(words.at.iter().map(|&word| motions[word]).collect()))
    }
}
