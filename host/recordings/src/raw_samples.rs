//! Raw samples from numbers that another program gives.

use shared::units::{CHANNELS, Sample};

/// A number that no armband sends.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[error("value {value} of row {row}: expected a raw sample, -128 to 127")]
pub struct NotRaw {
    /// The number.
    pub value: f64,
    /// Row, from 0.
    pub row: usize,
}

/// Samples of rows of eight whole numbers from -128 to 127; numbers after the last whole row are left out.
pub fn raw_samples(values: &[f64]) -> Result<Vec<Sample>, NotRaw> {
    if let Some(at) = values
        .iter()
        .position(|value| value.fract() != 0.0 || !(-128.0..=127.0).contains(value))
    {
        return Err(NotRaw {
            value: values[at],
            row: at / CHANNELS,
        });
    }
    let (rows, _) = values.as_chunks::<CHANNELS>();
    // Just checked.
    let sample = |row: &[f64; CHANNELS]| row.map(|value| value as i8);
    Ok(rows.iter().map(sample).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_of_a_byte_are_samples_and_no_others() {
        let mut values = vec![-128.0; 17];
        values[15] = 127.0;
        let mut last = [-128; 8];
        last[7] = 127;
        assert_eq!(raw_samples(&values).unwrap(), [[-128; 8], last]);
        for wrong in [128.0, -129.0, 0.5, f64::NAN, f64::INFINITY] {
            values[9] = wrong;
            assert_eq!(raw_samples(&values).unwrap_err().row, 1, "{wrong}");
        }
    }
}
