//! Columns of a user's own table: by the names in its header, or eight columns alone.
//!
//! Channels are eight numbered columns of one name (`emg_0` to `emg_7`, `EMG1` to `EMG8`); a label is in a column that
//! is called so. Without a header a table needs eight columns, beside others at its ends that rise from row to row as
//! times do.

use std::collections::BTreeMap;

use shared::units::CHANNELS;

use super::head::{Head, form};
use super::separator::Separator;
use super::shape::Shape;
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{self, Damage, EMPTY};
use crate::readers::table;

/// Names of columns that hold labels; the first is ReactEMG's and goes before the others.
#[rustfmt::skip]
const LABELS: [&str; 14] = [
    "gt", "label", "labels", "ann", "annotation", "annotations", "class", "gesture", "intent", "target", "truth",
    "ground_truth", "groundtruth", "y",
];
/// Words in the name of numbered columns that hold muscle activity.
const CHANNEL_NAMES: [&str; 6] = ["emg", "ch", "channel", "chan", "electrode", "sensor"];

/// Positions of the columns of a table.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Columns {
    /// Separator of the values of a row.
    pub separator: Separator,
    /// Names, empty without a header.
    pub names: Vec<String>,
    /// Number of columns.
    pub count: usize,
    /// Column of each channel.
    pub channels: [usize; CHANNELS],
    /// Column of the label.
    pub label: Option<usize>,
    /// Line of the first row of numbers, 1 first.
    pub first_line: usize,
}

/// Reason why a text is no table that is read.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct TableError {
    /// Fault, and its place.
    pub damage: Damage,
    /// Whether its columns show that it was meant as a recording.
    pub is_meant: bool,
    /// Whether it has columns, of which a description can say what they are.
    pub has_columns: bool,
}

impl TableError {
    fn new(line: usize, fault: impl Into<String>, is_meant: bool, has_columns: bool) -> Self {
        Self {
            damage: Damage::at_line(line, fault),
            is_meant,
            has_columns,
        }
    }
}

/// Fault of a text that is no table.
const NO_TABLE: &str = "expected rows of numbers separated by commas, semicolons, tabs or spaces, eight channels each, found other text";

impl Columns {
    /// The rows of a text below its header: line and fields of each.
    ///
    /// A row is an error when it has more or fewer fields than there are columns.
    pub(crate) fn rows<'t>(
        &self,
        text: &'t str,
    ) -> impl Iterator<Item = Result<(usize, Vec<&'t str>), Damage>> {
        self.lines(text).map(|(line, row)| {
            let fields = self.separator.fields(row);
            let (expected, found) = (self.count, fields.len());
            if found == expected {
                Ok((line, fields))
            } else {
                Err(Damage::at_line(line, error::fields(expected, found)))
            }
        })
    }

    /// The texts of one column, of a text whose rows are known to be whole. They are read anew each time: those of all
    /// columns may take many times the text's own memory.
    pub(crate) fn texts<'t>(&self, text: &'t str, at: usize) -> impl Iterator<Item = &'t str> {
        let field = move |(_, row)| self.separator.each(row).nth(at).unwrap_or_default();
        self.lines(text).map(field)
    }

    /// The rows of a text below its header, each with its line.
    fn lines<'t>(&self, text: &'t str) -> impl Iterator<Item = (usize, &'t str)> {
        table::rows(text).skip_while(|(line, _)| *line < self.first_line)
    }

    /// The columns of a text.
    pub fn of(text: &str) -> Result<Self, TableError> {
        let no_row = || TableError::new(1, EMPTY, false, false);
        let head = Head::of(text, None).ok_or_else(no_row)?;
        let found = if head.is_names {
            Self::named(&head)
        } else {
            Self::bare(text, &head)
        };
        found.map_err(|error| match form(text) {
            Some(fault) => TableError::new(head.line, fault, true, false),
            None => error,
        })
    }

    /// Position of the column of exactly this name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|own| own == name)
    }

    /// Columns that are neither channels nor label.
    pub fn others(&self) -> impl Iterator<Item = usize> {
        let taken = |at: &usize| self.channels.contains(at) || self.label == Some(*at);
        (0..self.count).filter(move |at| !taken(at))
    }

    /// Name of a column for messages.
    pub fn name(&self, at: usize) -> String {
        let name = self.names.get(at).map(|name| name.trim().to_owned());
        name.unwrap_or_else(|| unnamed(at))
    }

    fn named(head: &Head<'_>) -> Result<Self, TableError> {
        let names = &head.fields;
        let error = |found: &str, is_meant| {
            let has_columns = head.has_numbers || is_meant;
            let fault = if has_columns {
                format!(
                    "expected a header with eight channels of one name, such as gt,emg_0 to emg_7, found {found} in \"{}\" \
                     (separated by {}): name the eight columns of one armband so, and leave out those of other devices",
                    excerpt(head.text),
                    head.separator
                )
            } else {
                NO_TABLE.to_owned()
            };
            TableError::new(head.line, fault, is_meant, has_columns)
        };
        let groups = Group::all(names);
        let is_meant = groups.iter().any(Group::is_of_armbands);
        let channels = match channels(&groups) {
            Ok(channels) => channels,
            Err(found) => return Err(error(&found, is_meant)),
        };
        let known: Vec<String> = names.iter().map(|name| plain(name)).collect();
        let labels: Vec<usize> = (0..known.len())
            .filter(|&at| LABELS.contains(&known[at].as_str()))
            .collect();
        let ours = known.iter().position(|name| name == LABELS[0]);
        let label = match labels[..] {
            _ if ours.is_some() => ours,
            [] => None,
            [only] => Some(only),
            [..] => {
                let found: Vec<&str> = labels.iter().map(|&at| names[at]).collect();
                let found = format!(
                    "several columns of labels, {}, of which none is gt,",
                    found.join(", ")
                );
                return Err(error(&found, true));
            }
        };
        Ok(Self {
            channels,
            label,
            ..Self::of_head(head, true)
        })
    }

    /// Columns below a first row, which may be names; which of them are channels is open.
    pub(crate) fn of_head(head: &Head<'_>, is_names: bool) -> Self {
        let names = head.fields.iter().filter(|_| is_names);
        Self {
            separator: head.separator,
            names: names.map(|&name| name.to_owned()).collect(),
            count: head.fields.len(),
            channels: [0; CHANNELS],
            label: None,
            first_line: head.line + usize::from(is_names || head.is_comment),
        }
    }

    /// Columns of a table without names.
    fn bare(text: &str, head: &Head<'_>) -> Result<Self, TableError> {
        let fields = head.fields.iter();
        let numbers = fields.filter(|field| head.separator.is_number(field));
        if head.text.contains(['[', '{']) && numbers.count() >= CHANNELS / 2 {
            let fault = format!(
                "expected a number in each field, found lists in brackets, \"{}\": write one sample a row, eight numbers \
                 and the label",
                excerpt(head.text)
            );
            return Err(TableError::new(head.line, fault, true, false));
        }
        let is_alike = |shape: &Shape| shape.columns == head.fields.len();
        let Some(shape) = Shape::of(text).filter(is_alike) else {
            return Err(TableError::new(head.line, NO_TABLE, false, false));
        };
        let Shape {
            separator, columns, ..
        } = shape;
        let Some(start) = shape.channels(text) else {
            let fault = format!(
                "expected eight channels a row, found {columns} columns (separated by {separator}) and no header that says \
                 what they are: write one as first line, such as gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7"
            );
            let is_meant = columns > CHANNELS;
            return Err(TableError::new(head.line, fault, is_meant, true));
        };
        Ok(Self {
            separator,
            names: Vec::new(),
            count: columns,
            channels: std::array::from_fn(|channel| start + channel),
            label: None,
            first_line: head.line,
        })
    }
}

/// Name of a column without one.
pub(crate) fn unnamed(at: usize) -> String {
    format!("number {}", at + 1)
}

/// A name in lower case, without a unit in brackets, with `_` between words.
fn plain(name: &str) -> String {
    let name = name.split(['(', '[']).next().unwrap_or_default();
    name.trim().to_lowercase().replace([' ', '-', '.'], "_")
}

/// Numbered columns of one name.
pub(crate) struct Group {
    name: String,
    /// Column by number.
    columns: BTreeMap<usize, usize>,
    /// Whether a number occurs twice.
    is_doubled: bool,
}

impl Group {
    pub fn all(names: &[&str]) -> Vec<Self> {
        let mut groups: Vec<Self> = Vec::new();
        for (column, name) in names.iter().enumerate() {
            let name = plain(name);
            let word = name.trim_end_matches(|c: char| c.is_ascii_digit());
            let Ok(number) = name[word.len()..].parse::<usize>() else {
                continue;
            };
            let word = word.trim_end_matches(['_', '#', ':']);
            let at = groups.iter().position(|group| group.name == word);
            let at = at.unwrap_or_else(|| {
                groups.push(Self {
                    name: word.to_owned(),
                    columns: BTreeMap::new(),
                    is_doubled: false,
                });
                groups.len() - 1
            });
            groups[at].is_doubled |= groups[at].columns.insert(number, column).is_some();
        }
        groups
    }

    /// Number of the columns.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether the name says that it is muscle activity.
    pub fn is_muscle(&self) -> bool {
        let mut words = self.name.split('_');
        self.name.contains("emg") || words.any(|word| CHANNEL_NAMES.contains(&word))
    }

    /// Whether these may be the channels of an armband, or of two.
    fn is_of_armbands(&self) -> bool {
        let of_two = self.len() == 2 * CHANNELS || self.is_doubled && self.len() == CHANNELS;
        self.is_muscle() || self.channels().is_some() || of_two
    }

    /// The columns if they are those of eight channels.
    fn channels(&self) -> Option<[usize; CHANNELS]> {
        let numbers: Vec<usize> = self.columns.keys().copied().collect();
        let from = |first: usize| numbers.iter().copied().eq(first..first + CHANNELS);
        let columns: Vec<usize> = self.columns.values().copied().collect();
        let eight = !self.is_doubled && (from(0) || from(1));
        columns.try_into().ok().filter(|_| eight)
    }

    fn describe(&self) -> String {
        let numbers: Vec<String> = self.columns.keys().map(usize::to_string).collect();
        let twice = if self.is_doubled { ", some twice" } else { "" };
        format!(
            "{} columns {} ({}{twice})",
            numbers.len(),
            self.name,
            numbers.join(" ")
        )
    }
}

/// Columns of the eight channels, or a description of what there is instead.
pub(crate) fn channels(groups: &[Group]) -> Result<[usize; CHANNELS], String> {
    let is_series = |group: &&Group| group.columns.len() >= CHANNELS / 2;
    let (muscle, others): (Vec<&Group>, Vec<&Group>) = groups
        .iter()
        .filter(is_series)
        .partition(|group| group.is_muscle());
    let series = if muscle.is_empty() { others } else { muscle };
    if let [only] = series[..]
        && let Some(channels) = only.channels()
    {
        return Ok(channels);
    }
    let found: Vec<String> = series.iter().map(|group| group.describe()).collect();
    Err(match &found[..] {
        [] => "no numbered columns".to_owned(),
        found => found.join(" and "),
    })
}

#[cfg(test)]
mod tests;
