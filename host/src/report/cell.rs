//! Format of numbers in tables, the same in every table.

use crate::statistics::MeanSd;

/// In place of a missing number.
const NONE: &str = "-";

/// One cell, as text and as fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// As text, in a terminal or Markdown: `0.912 (0.04)`.
    pub shown: String,
    /// Its numbers one by one, as CSV keeps them; empty if there are none.
    pub fields: Vec<String>,
}

/// Names of a cell's fields, in CSV.
pub type Parts = &'static [&'static str];

/// One field, named as its column.
pub const ONE: Parts = &[""];
/// Mean and sample deviation.
pub const MEAN_SD: Parts = &["mean", "sd"];
/// Number of subjects and of transitions behind a score.
pub const SUPPORT: Parts = &["subjects", "transitions"];
/// A mean of paired differences.
pub const PAIRED: Parts = &["mean", "sd", "subjects"];

/// A name.
#[must_use]
pub fn text(text: impl Into<String>) -> Cell {
    let shown = text.into();
    Cell {
        fields: vec![shown.clone()],
        shown,
    }
}

/// A missing number.
#[must_use]
pub fn none() -> Cell {
    Cell {
        shown: NONE.to_owned(),
        fields: Vec::new(),
    }
}

/// A share of 1 over subjects: mean with three digits, deviation with two.
#[must_use]
pub fn share(value: Option<MeanSd>) -> Cell {
    spread(value, |mean| format!("{mean:.3}"), |sd| format!("{sd:.2}"))
}

/// Signed milliseconds, whole.
fn milliseconds(value: f64) -> String {
    format!("{:+.0}", unsigned_zero(value, 1.0))
}

/// One number, such as a median, in signed milliseconds.
#[must_use]
pub fn one_ms(value: Option<f64>) -> Cell {
    value.map_or_else(none, |value| text(milliseconds(value)))
}

/// Signed milliseconds over transitions, mean and deviation.
#[must_use]
pub fn signed_ms(value: Option<MeanSd>) -> Cell {
    spread(value, milliseconds, whole)
}

/// Absolute milliseconds over transitions, mean and deviation.
#[must_use]
pub fn absolute_ms(value: Option<MeanSd>) -> Cell {
    spread(value, whole, whole)
}

/// Number of subjects and of transitions behind a score: `subjects / transitions`.
#[must_use]
pub fn support(subjects: usize, transitions: usize) -> Cell {
    Cell {
        shown: format!("{subjects} / {transitions}"),
        fields: vec![subjects.to_string(), transitions.to_string()],
    }
}

/// Mean and deviation of a difference of shares over a number of subjects: `+0.012 (0.034) n 8`.
#[must_use]
pub fn difference(value: Option<MeanSd>, subjects: usize) -> Cell {
    let mean = |mean: f64| format!("{:+.3}", unsigned_zero(mean, 1000.0));
    let mut cell = spread(value, mean, |sd| format!("{sd:.3}"));
    if value.is_some() {
        cell.shown += &format!(" n {subjects}");
        cell.fields.push(subjects.to_string());
    }
    cell
}

fn spread(
    value: Option<MeanSd>,
    mean: impl Fn(f64) -> String,
    deviation: impl Fn(f64) -> String,
) -> Cell {
    let Some(value) = value else { return none() };
    let (mean, sd) = (mean(value.mean), value.sd.map(deviation));
    Cell {
        shown: match &sd {
            Some(sd) => format!("{mean} ({sd})"),
            None => mean.clone(),
        },
        fields: vec![mean, sd.unwrap_or_default()],
    }
}

fn whole(value: f64) -> String {
    format!("{:.0}", value.round())
}

/// Rounded to a step of 1 / `steps`; zero has no minus.
fn unsigned_zero(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_fields_hold_the_same_number() {
        let both = MeanSd {
            mean: 0.9116,
            sd: Some(0.044),
        };
        let one = MeanSd { sd: None, ..both };
        assert_eq!(share(Some(both)).shown, "0.912 (0.04)");
        assert_eq!(share(Some(both)).fields, ["0.912", "0.04"]);
        assert_eq!(share(Some(one)).shown, "0.912");
        assert_eq!(share(Some(one)).fields, ["0.912", ""]);
        assert_eq!(share(None), none());
        assert_eq!(support(8, 357).shown, "8 / 357");
        assert_eq!(difference(Some(both), 8).shown, "+0.912 (0.044) n 8");
        assert_eq!(difference(Some(both), 8).fields, ["+0.912", "0.044", "8"]);
    }

    #[test]
    fn what_rounds_to_zero_has_no_minus() {
        assert_eq!(milliseconds(-0.3), "+0");
        assert_eq!(milliseconds(-160.4), "-160");
        let tiny = MeanSd {
            mean: -0.0004,
            sd: None,
        };
        assert_eq!(difference(Some(tiny), 2).shown, "+0.000 n 2");
    }
}
