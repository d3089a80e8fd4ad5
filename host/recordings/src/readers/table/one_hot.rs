//! Labels as a column for each class, of which one is 1 in a row.

use super::columns::Columns;
use crate::labels::motion::Motion;

/// Words in front of a class in the name of such a column: `label_open`, `is_open`.
const PREFIXES: [&str; 9] = [
    "label", "labels", "class", "gesture", "pose", "intent", "target", "is", "gt",
];
/// Share of rows with exactly one 1 from which columns of unknown names look like labels.
const ONE: f64 = 0.99;

/// Columns that may have a label each, as rows are read.
pub(crate) struct OneHot<'c> {
    candidates: Vec<Candidate<'c>>,
    rows: usize,
}

struct Candidate<'c> {
    at: usize,
    name: &'c str,
    values: Vec<bool>,
}

/// Labels by columns of one label each.
pub(crate) enum Found {
    /// Labels of the rows, and a sentence on where they stand.
    Labels(Vec<Motion>, String),
    /// A sentence on columns that are not read.
    Unread(String),
}

impl<'c> OneHot<'c> {
    /// Candidates among the columns beside the channels, where no column has the labels.
    pub fn find(columns: &'c Columns) -> Self {
        let is_other = |at: &usize| columns.label.is_none() && !columns.channels.contains(at);
        let names = columns.names.iter().enumerate();
        let others = names.filter(|(at, _)| is_other(at));
        let candidate = |(at, name): (usize, &'c String)| Candidate {
            at,
            name: name.trim(),
            values: Vec::new(),
        };
        Self {
            candidates: others.map(candidate).collect(),
            rows: 0,
        }
    }

    /// Adds a row; a column with anything but 0 and 1 has no label.
    pub fn push(&mut self, fields: &[&str]) {
        self.rows += 1;
        self.candidates.retain_mut(|own| {
            let value = value(fields[own.at]);
            own.values.extend(value);
            value.is_some()
        });
    }

    /// Labels of the rows, if there are such columns.
    pub fn finish(mut self) -> Option<Found> {
        self.candidates.retain(|own| own.values.contains(&true));
        let names: Vec<&str> = self.candidates.iter().map(|own| own.name).collect();
        let of_row = |row: usize| {
            let mut own = self.candidates.iter();
            own.position(|own| own.values[row])
        };
        let count = |row: usize| self.candidates.iter().filter(|own| own.values[row]).count();
        let single = (0..self.rows).filter(|&row| count(row) == 1).count();
        let is_exclusive = (0..self.rows).all(|row| count(row) <= 1);
        let motions: Vec<Option<Motion>> = names.iter().map(|name| motion(name)).collect();
        let known = motions.iter().flatten().count();
        let names = names.join(", ");
        if known < 2 && !(is_exclusive && single as f64 >= ONE * self.rows as f64)
            || motions.len() < 2
        {
            return None;
        }
        if known < 2 || !is_exclusive {
            let reason = if is_exclusive {
                "their names are no classes"
            } else {
                "several are 1 at a time"
            };
            return Some(Found::Unread(format!(
                "columns {names} look like a label each and are not read, because {reason}: write one column gt"
            )));
        }
        let motion = |row| {
            of_row(row)
                .and_then(|at| motions[at])
                .unwrap_or(Motion::Unknown)
        };
        let labels = (0..self.rows).map(motion).collect();
        Some(Found::Labels(
            labels,
            format!("labels are read from columns {names}, the one that is 1"),
        ))
    }
}

/// Value of a field that is 0 or 1; none of another.
pub(crate) fn value(field: &str) -> Option<bool> {
    match field.to_ascii_lowercase().as_str() {
        "0" | "0.0" | "false" => Some(false),
        "1" | "1.0" | "true" => Some(true),
        _ => None,
    }
}

/// Motion that a column is called after.
fn motion(name: &str) -> Option<Motion> {
    let of = |name: &str| Motion::of_gesture(name).or_else(|| Motion::from_name(name));
    let rest = || {
        let (first, rest) = name.split_once(['_', ' ', '-', '.'])?;
        PREFIXES
            .contains(&first.to_lowercase().as_str())
            .then_some(rest)
    };
    of(name)
        .or_else(|| of(rest()?))
        .filter(|motion| *motion != Motion::Unknown)
}
