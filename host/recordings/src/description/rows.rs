//! Rows of a file as a description has them: samples, words of labels, a clock.

use std::path::{Path, PathBuf};

use shared::units::{CHANNELS, Sample};

use super::Description;
use super::values::Column;
use super::words::{Labels as Meanings, Words};
use crate::examiner::wide;
use crate::labels::motion::Motion;
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{self, Damage, EMPTY, LoadError, Place};
use crate::readers::label_file::{self, Purpose};
use crate::readers::npy::{self, Array, Values};
use crate::readers::table::auxiliary::Auxiliary;
use crate::readers::table::columns::{Columns, unnamed};
use crate::readers::table::head::Head;
use crate::readers::table::separator::Separator;
use crate::readers::table::{self, Samples};
use execution::file_kind::FileKind;

/// Labels of the rows, and where they stand.
pub(crate) struct Labels {
    pub(super) words: Option<Words>,
    pub(super) at: At,
}

/// Places of rows in their file.
pub(crate) enum At {
    /// A name.
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
    pub auxiliary: Auxiliary,
}

impl Rows {
    /// Samples with words of labels, and their places in the file.
    pub fn of(samples: Vec<Sample>, words: Option<Words>, at: At) -> Self {
        Self {
            samples,
            labels: Labels { words, at },
            labels_file: None,
            auxiliary: Auxiliary::default(),
        }
    }

    /// Motion of each row; unknown without labels.
    pub fn motions(&self, meanings: &Meanings, path: &Path) -> Result<Vec<Motion>, LoadError> {
        let path = self.labels_file.as_deref().unwrap_or(path);
        let motions = self.labels.motions(meanings);
        let motions = motions.map_err(|damage| damage.in_file(path))?;
        Ok(motions.unwrap_or_else(|| vec![Motion::Unknown; self.samples.len()]))
    }
}

impl Description {
    /// Rows of a file's bytes.
    pub(super) fn rows(&self, bytes: &[u8]) -> Result<Rows, Damage> {
        match FileKind::of(bytes) {
            FileKind::Npy => self.array(&npy::parse(bytes)?),
            FileKind::Table | FileKind::Text => {
                let text = str::from_utf8(bytes).map_err(Damage::of_text)?;
                let text = text.trim_start_matches('\u{feff}');
                wide::in_table(text, true)?;
                self.table(text, &self.columns(text)?)
            }
            FileKind::Empty => Err(Damage::of_file(EMPTY)),
            found => {
                let expected = "a table of text or an npy array, as a description has them";
                Err(Damage::of_kind(expected, found))
            }
        }
    }

    /// Rows of a table of these columns.
    pub(super) fn table(&self, text: &str, columns: &Columns) -> Result<Rows, Damage> {
        let at = |time| position(time, &columns.names, columns.count, columns.first_line);
        let time = self.time.as_ref().map(at).transpose()?;
        let (mut samples, mut lines) = (Samples::default(), Vec::new());
        let mut words = columns.label.map(|_| Words::default());
        for row in columns.rows(text) {
            let (line, fields) = row?;
            let at_line = |fault| Damage::at_line(line, fault);
            let mut counts = [0.0; CHANNELS];
            for (count, &at) in counts.iter_mut().zip(&columns.channels) {
                let text = columns.separator.number(fields[at]);
                *count = table::number(at + 1, &text).map_err(at_line)? * self.scale;
            }
            samples.push(&counts, columns.channels[0] + 1, at_line);
            if let (Some(words), Some(label)) = (&mut words, columns.label) {
                words.push(fields[label]);
            }
            lines.push(line);
        }
        Ok(Rows {
            auxiliary: Auxiliary::of_table(text, columns, time),
            ..Rows::of(samples.finish()?, words, At::Lines(lines))
        })
    }

    /// Columns of a table.
    pub(super) fn columns(&self, text: &str) -> Result<Columns, Damage> {
        let mut columns = match &self.channels {
            None => Columns::of(text).map_err(|error| error.damage)?,
            Some(channels) => {
                let head = Head::of(text, self.separator);
                let head = head.ok_or_else(|| Damage::of_file(EMPTY))?;
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

    /// Rows of an array.
    pub(super) fn array(&self, array: &Array) -> Result<Rows, Damage> {
        let wrong = || {
            let expected =
                "numbers, (n, 8), or of more columns with a description that numbers eight of them";
            Damage::of_file(error::array(expected, &array.describe()))
        };
        let (Values::Numbers(values), &[_, width]) = (&array.values, &array.shape[..]) else {
            return Err(wrong());
        };
        let at = |column: &Column| position(column, &[], width, 1).map_err(|_| wrong());
        let mut channels: [usize; CHANNELS] = std::array::from_fn(|channel| channel);
        match &self.channels {
            Some(described) => {
                for (channel, column) in channels.iter_mut().zip(&described.0) {
                    *channel = at(column)?;
                }
            }
            None if width == CHANNELS => {}
            None => return Err(wrong()),
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
        let rows = values.chunks_exact(width.max(1));
        let mut samples = Samples::default();
        for (row, values) in rows.clone().enumerate() {
            let counts = channels.map(|channel: usize| values[channel] * self.scale);
            samples.push(&counts, channels[0] + 1, |fault| {
                Damage::at_byte(array.byte_of_row(row), fault)
            });
        }
        let column = |at: usize| rows.clone().map(move |row| row[at]);
        let words = label.map(|at| column(at).map(|value| value.to_string()).collect());
        Ok(Rows {
            auxiliary: Auxiliary::of_times(&columns, time, column),
            ..Rows::of(samples.finish()?, words, At::of(array))
        })
    }
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
        let found = excerpt(&found);
        let fault = format!("expected column {column} of the description, found {found}");
        Damage::at_line(line, fault)
    })
}

/// Words of a file with a label a sample: an npy array, whose first column is read, or text.
pub(crate) fn labels(bytes: &[u8], purpose: Purpose) -> Result<Labels, Damage> {
    if FileKind::of(bytes) == FileKind::Npy {
        let array = npy::parse(bytes)?;
        let columns = match array.shape[..] {
            [_] => 1,
            [_, columns @ (1 | 9)] => columns,
            _ => {
                let fault = error::array("labels, (n) or (n, 9)", &array.describe());
                return Err(Damage::of_file(fault));
            }
        };
        let words = match &array.values {
            Values::Numbers(values) => {
                let values = values.iter().step_by(columns);
                values.map(f64::to_string).collect()
            }
            Values::Text(texts) => texts.iter().step_by(columns).collect(),
        };
        return Ok(Labels {
            words: Some(words),
            at: At::of(&array),
        });
    }
    let rows = label_file::rows(bytes, purpose)?;
    Ok(Labels {
        words: Some(rows.iter().map(|(_, word)| word).collect()),
        at: At::Lines(rows.into_iter().map(|(line, _)| line).collect()),
    })
}

impl Labels {
    /// The labels if there is one for each sample.
    pub(super) fn of_each(self, samples: usize) -> Result<Self, Damage> {
        let labels = self.words.as_ref().map_or(0, |words| words.at.len());
        if labels == samples {
            return Ok(self);
        }
        Err(Damage::of_file(error::label_count(samples, labels)))
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
