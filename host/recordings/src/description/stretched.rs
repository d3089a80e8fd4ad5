//! Rows of `uci-gestures` at 200 Hz.
//!
//! About half of the samples were lost before publication, and the rest was held at 1000 rows a second: rows that
//! repeat the one before are no samples. Those left are filtered by a median of three and then stretched to
//! 200 Hz. Good for which muscles are active, not for what a sample looks like.

use shared::units::{CHANNELS, SAMPLE_PERIOD_MS, Sample};

use super::rows::Rows;
use crate::examiner::repeats::first_of_each;
use crate::readers::error::Damage;

/// Largest gap between two rows, in ms: 175 in the published files.
const GAP: f64 = 1000.0;
/// Longest recording, in s; the published ones last a minute or two. A row may stand for many samples, so the file's
/// length is no bound.
const LONGEST: f64 = 3600.0;
/// Largest time between rows of one burst, in ms.
const BURST: f64 = 2.0;

/// Stretches rows to 200 Hz, by their times in ms.
pub(super) fn stretch(rows: &mut Rows) -> Result<(), Damage> {
    let clock = rows.auxiliary.clock.as_ref();
    let times: &[f64] = clock.map_or(&[], |clock| &clock.times);
    for (row, pair) in times.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        let seconds = (to - times[0]) / 1000.0;
        let fault = if !(0.0..=GAP).contains(&(to - from)) {
            format!(
                "expected times that rise by at most {GAP} ms from row to row, found {from} and then {to}"
            )
        } else if seconds > LONGEST {
            format!("expected a recording of at most {LONGEST} s, found one of {seconds:.0} s")
        } else {
            continue;
        };
        return Err(Damage::at(rows.labels.at.place(row + 1), fault));
    }
    let is_first = first_of_each(&rows.samples);
    let kept: Vec<usize> = (0..is_first.len()).filter(|&row| is_first[row]).collect();
    let samples: Vec<Sample> = kept.iter().map(|&row| rows.samples[row]).collect();
    let filtered = median_of_three(&samples);
    let times: Vec<f64> = kept.iter().map(|&row| times[row]).collect();
    let slots = slots(&times);
    rows.samples = slots.iter().map(|&at| filtered[at]).collect();
    if let Some(words) = &mut rows.labels.words {
        words.at = slots.iter().map(|&at| words.at[kept[at]]).collect();
    }
    Ok(())
}

/// Each channel's median of a row and its neighbours; the first and last row stay.
fn median_of_three(samples: &[Sample]) -> Vec<Sample> {
    let mut filtered = samples.to_vec();
    for (at, three) in samples.windows(3).enumerate() {
        for channel in 0..CHANNELS {
            let mut values = [0, 1, 2].map(|index| three[index][channel]);
            values.sort_unstable();
            filtered[at + 1][channel] = values[1];
        }
    }
    filtered
}

/// Number of the row at each slot of 5 ms: the slots since the last burst are shared among the rows of a burst.
fn slots(times: &[f64]) -> Vec<usize> {
    let (mut slots, mut first) = (Vec::new(), 0);
    for burst in times.chunk_by(|a, b| b - a <= BURST) {
        let last = burst[burst.len() - 1] - times[0];
        // Bounded by GAP: no more than 200 slots a burst.
        let end = (last / f64::from(SAMPLE_PERIOD_MS)).floor() as usize + 1;
        let count = end - slots.len().min(end);
        slots.extend((0..count).map(|slot| first + slot * burst.len() / count));
        first += burst.len();
    }
    slots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_are_shared_among_the_rows_of_a_burst() {
        assert_eq!(slots(&[0.0, 20.0, 21.0, 40.0]), [0, 1, 1, 2, 2, 3, 3, 3, 3]);
        let faster: Vec<f64> = (0..100).map(|at| 2.5 * f64::from(at)).collect();
        assert_eq!(slots(&faster).len(), 50);
    }

    #[test]
    fn the_median_removes_a_single_peak() {
        let filtered = median_of_three(&[[1; 8], [90; 8], [3; 8], [2; 8]]);
        assert_eq!(filtered, [[1; 8], [3; 8], [3; 8], [2; 8]]);
    }
}
