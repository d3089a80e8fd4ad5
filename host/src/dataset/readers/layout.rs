//! Which of the text formats a file has, from its first rows.

use super::formats::{myo_rps, react_emg, uci_gestures};
use super::table;

/// Layouts of the text formats.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Layout {
    ReactEmg,
    MyoRps,
    UciGestures,
    MyoReadings,
    SsStm,
    /// Eight whole numbers a row: `one-subject-myo`, or anything else.
    Counts,
}

/// Rows examined: one damaged row among them must not hide the format.
const EXAMINED: usize = 20;

impl Layout {
    /// Recognises the format by the header, or by the number of values in a row, whole or decimal.
    pub(crate) fn of(text: &str) -> Option<Self> {
        if react_emg::has_header(text) {
            return Some(Self::ReactEmg);
        }
        if myo_rps::has_header(text) {
            return Some(Self::MyoRps);
        }
        if uci_gestures::has_header(text) {
            return Some(Self::UciGestures);
        }
        let rows: Vec<_> = table::rows(text).take(EXAMINED).collect();
        let most = |count: usize| 2 * count > rows.len();
        let nine = rows
            .iter()
            .filter(|(line, row)| table::numbers::<9>(*line, row).is_ok());
        if most(nine.count()) {
            return Some(Self::MyoReadings);
        }
        let eight: Vec<_> = rows
            .iter()
            .filter_map(|(line, row)| table::numbers::<8>(*line, row).ok())
            .collect();
        if !most(eight.len()) {
            return None;
        }
        let decimal = |row: &&[f64; 8]| {
            row.iter().all(|value| value.abs() <= 1.0) && row.iter().any(|v| v.fract() != 0.0)
        };
        let decimals = eight.iter().filter(decimal).count();
        Some(if most(decimals) {
            Self::SsStm
        } else {
            Self::Counts
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_formats_are_recognised_by_their_rows() {
        let header = "gt,emg0,emg1,emg2,emg3,emg4,emg5,emg6,emg7\n0,0,0,0,0,0,0,0,0\n";
        assert_eq!(Layout::of(header), Some(Layout::ReactEmg));
        assert_eq!(Layout::of("1,2,3,4,5,6,7,8,0\n"), Some(Layout::MyoReadings));
        assert_eq!(Layout::of("-0.5,0,0,0,0,0,1,-1\n"), Some(Layout::SsStm));
        assert_eq!(Layout::of("1,2,3,4,5,6,7,8\r\n"), Some(Layout::Counts));
        let rock = "index,timestamp,0,1,2,3,4,5,6,7\r\n0,5,1,2,3,4,5,6,7,8\r\n";
        assert_eq!(Layout::of(rock), Some(Layout::MyoRps));
        assert_eq!(Layout::of("Sex,M,,\nAge,24,,\n"), None);
        assert_eq!(Layout::of(""), None);
    }

    #[test]
    fn a_damaged_first_row_does_not_hide_the_format() {
        let text = format!("1,2,3,4\n{}", "1,2,3,4,5,6,7,8,0\n".repeat(9));
        assert_eq!(Layout::of(&text), Some(Layout::MyoReadings));
    }
}
