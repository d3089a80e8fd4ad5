//! Rows of numbers: what the text formats share, and numbers as samples.

pub(crate) mod auxiliary;
pub(crate) mod columns;
pub(crate) mod head;
pub(crate) mod one_hot;
pub(crate) mod separator;
pub(crate) mod shape;

use shared::units::{CHANNELS, Sample};

use crate::examiner::scale::ScaleDetector;
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{Damage, EMPTY};

/// The rows of a text, each with its line number. Empty lines are no rows, nor are separators alone, as spreadsheets
/// write them.
pub(crate) fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_mark = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '"');
    lines(text).filter(move |(_, line)| !line.chars().all(is_mark))
}

/// The lines of a text, each with its number, without empty ones at the end. A line may be a label, and an empty one none.
///
/// Takes LF, CRLF, spaces around values, and a last line with or without an end.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.trim_end()
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
}

/// Whether a row in front of a table is no part of it: a comment, or the separator as spreadsheets note it.
pub(crate) fn is_note(row: &str) -> bool {
    let row = row.trim();
    row.starts_with('#') || row.to_lowercase().starts_with("sep=")
}

/// One field as a finite number; whole numbers first, which parse faster: files have millions of them.
pub(crate) fn number(field: usize, text: &str) -> Result<f64, String> {
    if let Ok(whole) = text.parse::<i32>() {
        return Ok(f64::from(whole));
    }
    let number = text.parse::<f64>().ok().filter(|value| value.is_finite());
    let text = || excerpt(text);
    number.ok_or_else(|| format!("expected a number in field {field}, found \"{}\"", text()))
}

/// Eight counts of the armband as a sample; `first_field` is where they start in the row.
///
/// Counts off a whole number by up to 0.01 are rounded (decimals were printed short); +128, which
/// a rescaled source may hold, is the armband's 127.
pub(crate) fn sample(counts: &[f64], first_field: usize) -> Result<Sample, String> {
    let mut sample = [0; CHANNELS];
    for (channel, (to, &value)) in sample.iter_mut().zip(counts).enumerate() {
        let whole = value.round();
        if !(-128.0..=128.0).contains(&whole) || (value - whole).abs() > 0.01 {
            let field = first_field + channel;
            return Err(format!(
                "expected a count of the armband in field {field}, a whole number from -128 to 127, found {value}"
            ));
        }
        *to = whole.min(127.0) as i8;
    }
    Ok(sample)
}

/// Samples of a file as they are read. Their scale is judged by all of them, before the first that is no count is
/// reported.
#[derive(Default)]
pub(crate) struct Samples {
    scale: ScaleDetector,
    samples: Vec<Sample>,
    fault: Option<Damage>,
}

impl Samples {
    /// Adds a row's counts; `first_field` is where they start, and `at` adds the place to a fault.
    pub fn push(&mut self, counts: &[f64], first_field: usize, at: impl FnOnce(String) -> Damage) {
        self.scale.push(counts);
        match sample(counts, first_field) {
            Ok(sample) => self.samples.push(sample),
            Err(fault) => {
                self.fault.get_or_insert_with(|| at(fault));
            }
        }
    }

    /// Returns the samples.
    ///
    /// # Errors
    /// A scale other than counts; else the first value that is no count; else that there are no samples.
    pub fn finish(self) -> Result<Vec<Sample>, Damage> {
        self.scale.finish()?;
        match self.fault {
            Some(fault) => Err(fault),
            None if self.samples.is_empty() => Err(Damage::of_file(EMPTY)),
            None => Ok(self.samples),
        }
    }
}
