//! Rows with more values than a sample of one armband has: two armbands side by side, or several samples in a row.

use shared::units::CHANNELS;

use super::bands::TWO_ARMBANDS;
use super::finding::Finding;
use super::scale::ScaleDetector;
use crate::readers::table::columns::{Group, channels};
use crate::readers::table::head::Head;
use crate::readers::table::shape::{Shape, first_numbers};

/// Least number of values in a row from which they are several samples: fewer are two armbands.
const SEVERAL: usize = 3 * CHANNELS;

/// Refuses a table whose rows have several samples; one without names, if it is not described, also if they have the
/// channels of two armbands.
pub(crate) fn in_table(text: &str, is_described: bool) -> Result<(), Finding> {
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
    let (columns, numbers) = (shape.columns, shape.numbers);
    let rows = first_numbers(text, numbers);
    if is_described || head.is_some() {
        return several(columns, numbers, &rows);
    }
    in_rows(columns, numbers, &rows)
}

/// Refuses rows of numbers with the channels of two armbands, or several samples; `columns` may hold one more, a word.
pub(crate) fn in_rows(columns: usize, numbers: usize, rows: &[Vec<f64>]) -> Result<(), Finding> {
    const TWO: usize = 2 * CHANNELS;
    several(columns, numbers, rows)?;
    if (TWO..=TWO + 1).contains(&columns) && are_counts(rows) {
        let what =
            format!("expected {CHANNELS} channels, found {columns} columns: those of two armbands");
        let advice = "keep the columns of one armband in a file";
        return Err(Finding::warning(TWO_ARMBANDS, what, advice));
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
