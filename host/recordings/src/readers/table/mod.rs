//! Rows of numbers: what the text formats share, and arrays and matrices as samples.

pub(crate) mod auxiliary;
pub(crate) mod columns;
pub(crate) mod head;
pub(crate) mod one_hot;
pub(crate) mod separator;
pub(crate) mod shape;

use shared::units::{CHANNELS, Sample};

use crate::examiner::scale::ScaleDetector;
use crate::readers::error::{Damage, Fault};
use crate::readers::mat::Matrix;

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
pub(crate) fn number(line: usize, field: usize, text: &str) -> Result<f64, Damage> {
    if let Ok(whole) = text.parse::<i32>() {
        return Ok(f64::from(whole));
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Damage::at_line(
            line,
            Fault::Number {
                field,
                text: text.to_owned(),
            },
        )),
    }
}

/// Eight counts of the armband as a sample; `first_field` is where they start in the row.
///
/// Counts off a whole number by up to 0.01 are rounded (decimals were printed short); +128, which
/// a rescaled source may hold, is the armband's 127.
pub(crate) fn sample(counts: &[f64], first_field: usize) -> Result<Sample, Fault> {
    let mut sample = [0; CHANNELS];
    for (channel, (to, &value)) in sample.iter_mut().zip(counts).enumerate() {
        let whole = value.round();
        if !(-128.0..=128.0).contains(&whole) || (value - whole).abs() > 0.01 {
            return Err(Fault::Range {
                field: first_field + channel,
                value,
            });
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
    pub fn push(&mut self, counts: &[f64], first_field: usize, at: impl FnOnce(Fault) -> Damage) {
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
        self.scale.finish().map_err(Damage::refused)?;
        match self.fault {
            Some(fault) => Err(fault),
            None if self.samples.is_empty() => Err(Damage::of_file(Fault::Empty)),
            None => Ok(self.samples),
        }
    }
}

/// A matrix n x 8 of counts over `divisor` as samples.
pub(crate) fn matrix(matrix: &Matrix, divisor: f64) -> Result<Vec<Sample>, Damage> {
    let at = |fault| Damage::at_byte(matrix.byte, fault);
    let [rows, CHANNELS] = matrix.shape else {
        return Err(at(Fault::Array {
            expected: "numbers, n x 8",
            found: matrix.describe(),
        }));
    };
    let of_row = |row| {
        let counts: [f64; CHANNELS] = std::array::from_fn(|c| matrix.at(row, c) * divisor);
        sample(&counts, 1).map_err(at)
    };
    let samples: Vec<Sample> = (0..rows).map(of_row).collect::<Result<_, _>>()?;
    if samples.is_empty() {
        return Err(Damage::of_file(Fault::Empty));
    }
    Ok(samples)
}
