//! Rows with more values than a sample of one armband has: two armbands side by side, or several samples in a row.

use std::collections::BTreeMap;

use shared::units::CHANNELS;

use super::bands::TWO_ARMBANDS;
use super::finding::Finding;
use super::scale::ScaleDetector;
use crate::readers::table::columns::{Group, channels};
use crate::readers::table::head::Head;
use crate::readers::table::shape::{Shape, first_numbers};

/// Names of numbered columns that are no EMG: the armband's other sensors.
#[rustfmt::skip]
const OTHERS: [&str; 12] = [
    "acc", "accel", "accelerometer", "gyro", "gyr", "gyroscope", "quat", "orientation", "ori", "mag", "imu", "rot",
];
/// Words that name an armband, beside those of muscle activity.
#[rustfmt::skip]
const ARMBANDS: [&str; 11] = [
    "left", "right", "l", "r", "links", "rechts", "arm", "armband", "band", "myo", "device",
];
/// Least number of values in a row from which they are several samples: fewer are two armbands.
const SEVERAL: usize = 3 * CHANNELS;

/// Advice on the columns of two armbands.
const ONE_ARMBAND: &str = "keep the columns of one armband in a file";

/// Refuses a table whose rows have the channels of two armbands, or several samples.
pub(crate) fn in_table(text: &str) -> Result<(), Finding> {
    windows(text)?;
    let head = Head::of(text, None);
    match (head.filter(|head| head.is_names), Shape::of(text)) {
        (Some(head), _) => in_header(&head.fields),
        (None, Some(shape)) => in_rows(shape.columns, shape.numbers, &first_numbers(text)),
        (None, None) => Ok(()),
    }
}

/// Refuses a table whose rows have several samples.
pub(crate) fn windows(text: &str) -> Result<(), Finding> {
    let head = Head::of(text, None).filter(|head| head.is_names);
    let groups = Group::all(head.as_ref().map_or(&[], |head| &head.fields));
    if channels(&groups).is_ok() {
        return Ok(());
    }
    let muscle = groups.iter().filter(|group| group.is_muscle());
    let named: usize = muscle.map(Group::len).sum();
    if named >= SEVERAL && named.is_multiple_of(CHANNELS) {
        return Err(windowed(named));
    }
    let Some(shape) = Shape::of(text) else {
        return Ok(());
    };
    several(shape.columns, shape.numbers, &first_numbers(text))
}

/// Refuses rows of numbers with the channels of two armbands, or several samples; `columns` may hold one more, a word.
pub(crate) fn in_rows(columns: usize, numbers: usize, rows: &[Vec<f64>]) -> Result<(), Finding> {
    const TWO: usize = 2 * CHANNELS;
    several(columns, numbers, rows)?;
    if (TWO..=TWO + 1).contains(&columns) && are_counts(rows) {
        let what =
            format!("expected {CHANNELS} channels, found {columns} columns: those of two armbands");
        return Err(Finding::warning(TWO_ARMBANDS, what, ONE_ARMBAND));
    }
    Ok(())
}

/// Refuses rows of several samples, with at most a label beside them. Features of them are no counts, or never negative.
fn several(columns: usize, numbers: usize, rows: &[Vec<f64>]) -> Result<(), Finding> {
    let values = numbers / CHANNELS * CHANNELS;
    let is_negative = || rows.iter().flatten().any(|&value| value < 0.0);
    if values >= SEVERAL && columns <= values + 1 && is_negative() && are_counts(rows) {
        return Err(windowed(values));
    }
    Ok(())
}

fn windowed(values: usize) -> Finding {
    Finding::warning(
        "windows",
        format!(
            "expected a sample of {CHANNELS} channels a row, found {values} values: {} samples a row",
            values / CHANNELS
        ),
        "write each sample, channels 1 to 8, into a row of its own, with its label",
    )
}

/// Whether values are counts, or of a scale that makes them counts. Either end of a row may be a label.
fn are_counts(rows: &[Vec<f64>]) -> bool {
    let mut detector = ScaleDetector::default();
    for row in rows {
        detector.push(row.get(1..row.len().max(2) - 1).unwrap_or_default());
    }
    detector.scale().step().is_some()
}

/// Refuses a header with the channels of two armbands.
fn in_header(names: &[&str]) -> Result<(), Finding> {
    let mut groups: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for name in names {
        let prefix = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let key = prefix.trim_end_matches(['_', '-', ' ', '.']).to_lowercase();
        if prefix.len() < name.len() && is_of_armband(&key) {
            groups.entry(key).or_default().push(name);
        }
    }
    let full: Vec<&Vec<&str>> = groups
        .values()
        .filter(|names| names.len() >= CHANNELS)
        .collect();
    let columns = |names: &[&str]| -> Option<String> {
        Some(format!(
            "{} to {}",
            names.first()?,
            names.get(CHANNELS - 1)?
        ))
    };
    let armbands = match full[..] {
        [names] if names.len() >= 2 * CHANNELS => {
            vec![columns(names), columns(&names[CHANNELS..])]
        }
        [] | [_] => return Ok(()),
        _ => full.iter().map(|names| columns(names)).collect(),
    };
    let armbands: Vec<String> = armbands.into_iter().flatten().collect();
    let what = format!(
        "expected {CHANNELS} columns of EMG, found those of {} armbands: {}",
        armbands.len(),
        armbands.join("; ")
    );
    Err(Finding::warning(TWO_ARMBANDS, what, ONE_ARMBAND))
}

/// Whether the name of numbered columns is one of muscle activity or of an armband: features have other names.
fn is_of_armband(key: &str) -> bool {
    let digits = |c: char| c.is_ascii_digit();
    let words = key.split(['_', '-', ' ', '.']);
    let words: Vec<&str> = words.map(|word| word.trim_end_matches(digits)).collect();
    let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
    !has(&OTHERS) && (has(&ARMBANDS) || Group::is_muscle_name(key))
}
