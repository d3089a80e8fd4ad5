//! Labels as a column for each class, of which one is 1 in a row.

use super::columns::Columns;
use crate::labels::motion::Motion;

/// Words in front of a class in the name of such a column: `label_open`, `is_open`.
const PREFIXES: [&str; 9] = [
    "label", "labels", "class", "gesture", "pose", "intent", "target", "is", "gt",
];
/// Share of rows with exactly one 1 from which columns of unknown names look like labels.
const ONE: f64 = 0.99;

/// Labels by columns of one label each.
pub(crate) enum Found {
    /// Labels of the rows, and a sentence on where they stand.
    Labels(Vec<Motion>, String),
    /// A sentence on columns that are not read.
    Unread(String),
}

/// Labels of the rows by columns beside the channels, where no column has the labels; none without such columns.
pub(crate) fn find(text: &str, columns: &Columns) -> Option<Found> {
    if columns.label.is_some() || columns.names.is_empty() {
        return None;
    }
    // A column with anything but 0 and 1, or without a 1, has no label.
    let others = columns.others().map(|at| (at, Some(Vec::new())));
    let mut others: Vec<(usize, Option<Vec<bool>>)> = others.collect();
    for (_, fields) in columns.rows(text).map_while(Result::ok) {
        for (at, values) in &mut others {
            match (&mut *values, value(fields[*at])) {
                (Some(values), Some(value)) => values.push(value),
                _ => *values = None,
            }
        }
    }
    let with_one = |(at, values): (usize, Option<Vec<bool>>)| {
        let values = values.filter(|values| values.contains(&true))?;
        Some((columns.names[at].trim(), values))
    };
    let found: Vec<(&str, Vec<bool>)> = others.into_iter().filter_map(with_one).collect();
    let rows = found.first().map_or(0, |(_, values)| values.len());
    let count = |row: usize| found.iter().filter(|(_, values)| values[row]).count();
    let single = (0..rows).filter(|&row| count(row) == 1).count();
    let is_exclusive = (0..rows).all(|row| count(row) <= 1);
    let motions = found.iter().map(|(name, _)| motion(name));
    let motions: Vec<Option<Motion>> = motions.collect();
    let known = motions.iter().flatten().count();
    let looks_alike = is_exclusive && single as f64 >= ONE * rows as f64;
    if motions.len() < 2 || known < 2 && !looks_alike {
        return None;
    }
    let names: Vec<&str> = found.iter().map(|(name, _)| *name).collect();
    let names = names.join(", ");
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
    let motion = |row: usize| {
        let at = found.iter().position(|(_, values)| values[row]);
        at.and_then(|at| motions[at]).unwrap_or(Motion::Unknown)
    };
    Some(Found::Labels(
        (0..rows).map(motion).collect(),
        format!("labels are read from columns {names}, the one that is 1"),
    ))
}

/// Value of a field that is 0 or 1; none of another.
fn value(field: &str) -> Option<bool> {
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
