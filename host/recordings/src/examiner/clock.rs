//! Clock of a recording: a column of times or sample numbers, which gives the rate and the gaps.
//!
//! A column is a clock by its name, or because it rises evenly, as nothing else does.

mod instant;
mod rising;

use shared::units::SAMPLE_RATE_HZ;

pub(crate) use instant::seconds_of;
use rising::{period, rises_often, unwrapped};
pub(crate) use rising::{rises, rises_evenly};

/// Names of columns that say when a row was sampled; a unit may follow.
#[rustfmt::skip]
const TIMES: [&str; 9] = [
    "time", "timestamp", "timestamps", "t", "ts", "datetime", "date", "clock", "elapsed",
];
/// Names of columns that count rows or samples.
#[rustfmt::skip]
const COUNTERS: [&str; 16] = [
    "index", "idx", "sample", "samples", "row", "frame", "counter", "count", "packet", "seq", "sequence", "number",
    "nr", "no", "n", "unnamed: 0",
];
/// Units of times: names, and number of units in a second.
#[rustfmt::skip]
const UNITS: [(&[&str], f64); 4] = [
    (&["s", "sec", "secs", "second", "seconds", "unix"], 1.0),
    (&["ms", "msec", "milli", "millis", "millisecond", "milliseconds"], 1e3),
    (&["us", "\u{b5}s", "\u{3bc}s", "usec", "micro", "micros", "microsecond", "microseconds"], 1e6),
    (&["ns", "nsec", "nano", "nanos", "nanosecond", "nanoseconds"], 1e9),
];
/// Seconds from row to row that are plausible for a unit without a name.
const PERIODS: std::ops::Range<f64> = 0.0005..0.5;
/// Rows on either side of a gap whose earliest arrivals are compared: a late arrival alone is no gap.
const AROUND: usize = 200;
/// Missing seconds from which there is a gap: a board bridges 25 ms and restarts its window after more.
const GAP: f64 = 0.05;

/// Rows of a column without a known name, and the share of later ones, that may go back until it is no clock for certain:
/// more than those of the shortest counter.
const MAY_GO_BACK: (usize, f64) = (16, 0.15);
/// Rows of a column without a known name after which it is no clock if it has risen too seldom.
const MAY_STAND_STILL: usize = 10 * SAMPLE_RATE_HZ as usize;

/// Column of times of a recording, one value per row.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Clock {
    /// The column's name.
    pub name: String,
    /// Values of the column; dates and times of day in seconds.
    pub times: Vec<f64>,
    /// Whether its name or a description says that it is a clock.
    is_meant: bool,
}

/// Rate of the rows by a clock, and gaps between them.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Timebase {
    /// Rows per second, gaps left out.
    pub hz: f64,
    /// Gaps in order: the first row after each, and its seconds; negative if the times go back.
    pub gaps: Vec<(usize, f64)>,
}

/// Kind of a column.
#[derive(Clone, Copy, PartialEq, Debug)]
enum ClockKind {
    /// Times; how many are a second if the name says so.
    Times(Option<f64>),
    /// Sample numbers.
    Counter,
}

/// Kind of a column by its name; none if it is no clock.
fn kind(name: &str) -> Option<ClockKind> {
    let name = name.trim().trim_matches('"').to_lowercase();
    let words = name.split(|c: char| !c.is_alphanumeric());
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let is_counter = |word: &&str| COUNTERS.contains(word);
    // `sample_index`, `row number`
    if is_counter(&&*name) || words.len() > 1 && words.iter().all(is_counter) {
        return Some(ClockKind::Counter);
    }
    let unit = |word: &str| {
        let known = UNITS.iter().find(|(names, _)| names.contains(&word));
        known.map(|(_, per_second)| *per_second)
    };
    let (times, others): (Vec<&str>, Vec<&str>) =
        words.iter().copied().partition(|word| TIMES.contains(word));
    if !times.is_empty() {
        return Some(ClockKind::Times(others.into_iter().find_map(unit)));
    }
    // `timems`, `milliseconds`
    let glued = |word: &str| TIMES.iter().find_map(|time| unit(word.strip_prefix(time)?));
    let per_second = words.iter().find_map(|word| glued(word));
    let per_second = per_second.or_else(|| match words[..] {
        [word] if word == "millis" || word.ends_with("seconds") => unit(word),
        _ => None,
    });
    per_second.map(|per_second| ClockKind::Times(Some(per_second)))
}

impl Clock {
    /// Clock of a column of this name, by its values, NaN for a text that is no time: with one, the clock gives no rate.
    /// None if so many rows go back or stand still that it is no clock for certain, unless its name or a description calls it
    /// so: a table may have hundreds of columns.
    pub fn of(name: String, is_described: bool, values: impl Iterator<Item = f64>) -> Option<Self> {
        let is_meant = is_described || kind(&name).is_some();
        let (first, share) = MAY_GO_BACK;
        let mut times: Vec<f64> = Vec::new();
        let (mut back, mut up) = (0, 0);
        for time in values {
            if let Some(&before) = times.last() {
                back += usize::from(time.is_nan() || time < before);
                up += usize::from(time > before);
            }
            times.push(time);
            let goes_back = back as f64 > first as f64 + share * times.len() as f64;
            let stands_still = times.len() > MAY_STAND_STILL && !rises_often(up, times.len() - 1);
            if !is_meant && (goes_back || stands_still) {
                return None;
            }
        }
        Some(Self {
            name,
            times,
            is_meant,
        })
    }

    /// Clock of the rows that are kept.
    pub fn kept(&self, keep: &[bool]) -> Self {
        let times = self.times.iter().zip(keep);
        let times = times.filter(|(_, keep)| **keep).map(|(time, _)| *time);
        Self {
            times: times.collect(),
            ..self.clone()
        }
    }

    /// Whether the clock counts samples: by its name, or because it rises by exactly one and names no unit.
    pub fn counts(&self) -> bool {
        match kind(&self.name) {
            Some(ClockKind::Counter) => true,
            Some(ClockKind::Times(Some(_))) => false,
            _ => {
                let times = unwrapped(&self.times);
                let ones = times.windows(2).filter(|pair| pair[1] - pair[0] == 1.0);
                10 * ones.count() > 9 * times.len().saturating_sub(1)
            }
        }
    }

    /// Precedence among the clocks of a table, least first: times that give a rate, times that are meant and do not,
    /// counters; none if the column is no clock.
    pub(crate) fn precedence(&self) -> Option<(u8, bool)> {
        let is_clear = self.timebase().is_some();
        let is_clock = self.is_meant || is_clear && rises_evenly(&self.times);
        let rank = match (self.counts(), is_clear) {
            (false, true) => 0,
            (false, false) => 1,
            (true, _) => 2,
        };
        is_clock.then_some((rank, !self.is_meant))
    }

    /// Rate and gaps of the rows by this clock; none if the times do not rise, or no unit fits.
    pub(crate) fn timebase(&self) -> Option<Timebase> {
        let times = unwrapped(&self.times);
        let period = period(&times).filter(|period| *period > 0.0)?;
        let per_second = if self.counts() {
            f64::from(SAMPLE_RATE_HZ)
        } else if let Some(ClockKind::Times(Some(per_second))) = kind(&self.name) {
            per_second
        } else {
            let fits = |(_, per_second): &&(&[&str], f64)| PERIODS.contains(&(period / per_second));
            UNITS.iter().find(fits)?.1
        };
        let seconds: Vec<f64> = times.iter().map(|time| time / per_second).collect();
        let period = period / per_second;
        Some(Timebase {
            hz: 1.0 / period,
            gaps: gaps(&seconds, period),
        })
    }
}

/// Gaps: the first row after each, and its seconds.
///
/// Rows come late, never early. The earliest of many, each relative to its place in an even stream, gives the true
/// offset.
fn gaps(seconds: &[f64], period: f64) -> Vec<(usize, f64)> {
    let late = |row: usize| seconds[row] - row as f64 * period;
    let earliest = |rows: std::ops::Range<usize>| rows.map(late).fold(f64::INFINITY, f64::min);
    let mut gaps: Vec<(usize, f64)> = Vec::new();
    for row in 1..seconds.len() {
        let step = seconds[row] - seconds[row - 1];
        if step.abs() <= GAP && step >= 0.0 {
            continue;
        }
        let begin = gaps.last().map_or(0, |&(row, _)| row);
        let before = earliest(row.saturating_sub(AROUND).max(begin)..row);
        let after = earliest(row..seconds.len().min(row + AROUND));
        if (after - before).abs() > GAP {
            gaps.push((row, after - before));
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of which the square is more than a test can wait for.
    const MANY: usize = 1_000_000;

    #[test]
    fn work_grows_with_the_rows_and_not_with_their_square() {
        let times = (0..MANY).map(|row| (row * 5) as f64);
        let clock = Clock::of("time".to_owned(), false, times).unwrap();
        let gaps = Vec::new();
        assert_eq!(clock.timebase(), Some(Timebase { hz: 200.0, gaps }));
    }

    #[test]
    fn a_column_that_stands_still_is_given_up_after_some_rows() {
        let looked_at = |name: &str| {
            let mut rows = 0;
            let values = (0..MANY).map(|_| {
                rows += 1;
                0.0
            });
            let clock = Clock::of(name.to_owned(), false, values);
            (clock.is_some(), rows)
        };
        assert_eq!(looked_at("x"), (false, MAY_STAND_STILL + 1));
        assert_eq!(looked_at("time"), (true, MANY));
    }
}
