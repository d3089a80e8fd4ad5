//! Rows of comma-separated numbers: what the text formats share.

use shared::units::{CHANNELS, Sample};

use super::error::{Damage, Fault};

/// The rows of a text, each with its line number; empty lines at the end are no rows.
///
/// Takes LF, CRLF, spaces around values, and a last line with or without an end.
pub(crate) fn rows(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.trim_end()
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
}

/// One row as numbers; it has exactly `N`.
pub(crate) fn numbers<const N: usize>(line: usize, row: &str) -> Result<[f64; N], Damage> {
    let mut values = [0.0; N];
    let mut found = 0;
    for (index, text) in row.split(',').map(str::trim).enumerate() {
        found = index + 1;
        if let Some(value) = values.get_mut(index) {
            *value = number(line, found, text)?;
        }
    }
    if found == N {
        Ok(values)
    } else {
        Err(Damage::at_line(line, Fault::Fields { expected: N, found }))
    }
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
