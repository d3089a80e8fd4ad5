//! Clock of a recording: a column of times or sample numbers, which gives the rate and the gaps.

use shared::units::SAMPLE_RATE_HZ;

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
/// Largest deviation of an even step from the usual step, as a share of it.
const ALIKE: f64 = 0.2;
/// Rows over which a rate is averaged: times may come in bursts, or be whole seconds.
const AVERAGED: usize = 400;
/// Rows on either side of a gap whose earliest arrivals are compared: a late arrival alone is no gap.
const AROUND: usize = 200;
/// Missing seconds from which there is a gap: a board bridges 25 ms and restarts its window after more.
const GAP: f64 = 0.05;

/// Column of times of a recording, one value per row.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Clock {
    /// The column's name.
    pub name: String,
    /// Values of the column; dates and times of day in seconds.
    times: Vec<f64>,
}

/// Timebase that a clock gives.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Timebase {
    /// Rate of the rows, and gaps between them.
    Rate {
        /// Rows per second, gaps left out.
        hz: f64,
        /// Gaps in order: the first row after each, and its seconds; negative if the times go back.
        gaps: Vec<(usize, f64)>,
    },
    /// No rate: the times do not rise, or no unit fits.
    Unclear,
}

/// Kind of a column.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Kind {
    /// Times; how many are a second if the name says so.
    Times(Option<f64>),
    /// Sample numbers.
    Counter,
}

/// Kind of a column by its name; none if it is no clock.
fn kind(name: &str) -> Option<Kind> {
    let name = name.trim().trim_matches('"').to_lowercase();
    if COUNTERS.contains(&name.as_str()) {
        return Some(Kind::Counter);
    }
    let words: Vec<&str> = name
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .collect();
    let unit = |word: &str| UNITS.iter().find(|(names, _)| names.contains(&word));
    let is_time = |word: &str| TIMES.contains(&word);
    let glued = |word: &str| {
        let unit_of = |time: &&str| word.strip_prefix(*time).and_then(unit);
        TIMES.iter().find_map(unit_of)
    };
    if words.iter().any(|word| is_time(word)) {
        let unit = words
            .iter()
            .filter(|word| !is_time(word))
            .find_map(|word| unit(word));
        return Some(Kind::Times(unit.map(|(_, per_second)| *per_second)));
    }
    if let Some((_, per_second)) = words.iter().find_map(|word| glued(word)) {
        return Some(Kind::Times(Some(*per_second)));
    }
    match words[..] {
        [word]
            if [
                "seconds",
                "milliseconds",
                "millis",
                "microseconds",
                "nanoseconds",
            ]
            .contains(&word) =>
        {
            Some(Kind::Times(unit(word).map(|(_, per_second)| *per_second)))
        }
        // `sample_index`, `row number`
        _ if words.len() > 1 && words.iter().all(|word| COUNTERS.contains(word)) => {
            Some(Kind::Counter)
        }
        _ => None,
    }
}

/// Position of the clock's column among all names of a header; times take precedence over counters.
pub(crate) fn column<S: AsRef<str>>(names: &[S]) -> Option<usize> {
    let of = |wanted: fn(Kind) -> bool| {
        let mut kinds = names.iter().map(|name| kind(name.as_ref()));
        kinds.position(|kind| kind.is_some_and(wanted))
    };
    of(|kind| matches!(kind, Kind::Times(_))).or_else(|| of(|kind| kind == Kind::Counter))
}

impl Clock {
    /// Empty clock of a column of this name.
    pub const fn of(name: String) -> Self {
        Self {
            name,
            times: Vec::new(),
        }
    }

    /// Adds a row's text. A text that is no time becomes NaN, and the clock then gives no rate.
    pub fn push(&mut self, text: &str) {
        self.times.push(seconds_of(text).unwrap_or(f64::NAN));
    }

    /// Clock of the rows that are kept.
    pub fn kept(&self, keep: &[bool]) -> Self {
        let times = self.times.iter().zip(keep);
        Self {
            name: self.name.clone(),
            times: times
                .filter(|(_, keep)| **keep)
                .map(|(time, _)| *time)
                .collect(),
        }
    }

    /// Whether the clock counts samples: by its name, or because it rises by exactly one and names no unit.
    pub fn counts(&self) -> bool {
        match kind(&self.name) {
            Some(Kind::Counter) => true,
            Some(Kind::Times(Some(_))) => false,
            _ => {
                let steps = self.times.windows(2);
                let ones = steps.clone().filter(|pair| pair[1] - pair[0] == 1.0);
                10 * ones.count() > 9 * steps.len()
            }
        }
    }

    /// Rate and gaps of the rows by this clock.
    pub(crate) fn timebase(&self) -> Timebase {
        let times = self.unwrapped();
        let Some(period) = period(&times).filter(|period| *period > 0.0) else {
            return Timebase::Unclear;
        };
        let per_second = if self.counts() {
            f64::from(SAMPLE_RATE_HZ)
        } else if let Some(Kind::Times(Some(per_second))) = kind(&self.name) {
            per_second
        } else {
            let fits = |(_, per_second): &&(&[&str], f64)| PERIODS.contains(&(period / per_second));
            let Some((_, per_second)) = UNITS.iter().find(fits) else {
                return Timebase::Unclear;
            };
            *per_second
        };
        let seconds: Vec<f64> = times.iter().map(|time| time / per_second).collect();
        let period = period / per_second;
        Timebase::Rate {
            hz: 1.0 / period,
            gaps: gaps(&seconds, period),
        }
    }

    /// Values of the column; a counter of 8, 16 or 32 bits is unwrapped.
    fn unwrapped(&self) -> Vec<f64> {
        let counts = self.counts();
        let mut base = 0.0;
        let mut before: Option<f64> = None;
        let unwrapped = self.times.iter().map(|&time| {
            if let Some(before) = before.filter(|_| counts)
                && [256.0, 65_536.0, 4_294_967_296.0].contains(&(before + 1.0 - time))
            {
                base += before + 1.0 - time;
            }
            before = Some(time);
            base + time
        });
        unwrapped.collect()
    }
}

/// Usual step from row to row: the median of even steps, else the median over blocks of rows; none if a value is no
/// number or there are too few.
fn period(times: &[f64]) -> Option<f64> {
    if times.len() < 2 || times.iter().any(|time| !time.is_finite()) {
        return None;
    }
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let middle = steps[steps.len() / 2];
    let alike = steps
        .iter()
        .filter(|step| (*step - middle).abs() < ALIKE * middle);
    if 10 * alike.count() > 9 * steps.len() {
        return Some(middle);
    }
    let rows = ((times.len() - 1) / 8).clamp(1, AVERAGED);
    let ends = times.iter().step_by(rows);
    let mut steps: Vec<f64> = ends
        .clone()
        .zip(ends.skip(1))
        .map(|(from, to)| (to - from) / rows as f64)
        .collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
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

/// Seconds in a day.
const DAY: f64 = 86_400.0;

/// Parses a number, a date with a time of day, or a time of day, as seconds.
fn seconds_of(text: &str) -> Option<f64> {
    let text = text.trim().trim_matches('"');
    if let Ok(number) = text.parse::<f64>() {
        return number.is_finite().then_some(number);
    }
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) => (days(date)?, time.trim_start()),
        None => (0.0, text),
    };
    Some(date * DAY + time_of_day(time)?)
}

/// Days of a date such as `2021-03-04` since a fixed day.
fn days(text: &str) -> Option<f64> {
    let mut parts = text.split(['-', '/', '.']).map(str::parse::<u32>);
    let mut next = || parts.next()?.ok();
    let (year, month, day) = (next()?, next()?, next()?);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || year > 9999 {
        return None;
    }
    // Days from March on, as calendars are computed: leap days come last in a year.
    let (year, month) = if month < 3 {
        (year.checked_sub(1)?, month + 9)
    } else {
        (year, month - 3)
    };
    let leaps = year / 4 + year / 400 - year / 100;
    Some(f64::from(365 * year + leaps + (153 * month + 2) / 5 + day))
}

/// Seconds of a time of day such as `12:30:05.125`; a time zone behind it is ignored.
fn time_of_day(text: &str) -> Option<f64> {
    let text = text.trim_end_matches('Z');
    let zone = text.rfind(['+', '-']).filter(|&at| at > 0);
    let text = zone.map_or(text, |at| &text[..at]).trim_end();
    let mut parts = text.split(':');
    let mut next = || {
        parts
            .next()?
            .parse::<f64>()
            .ok()
            .filter(|part| *part >= 0.0)
    };
    let (hours, minutes, seconds) = (next()?, next()?, next()?);
    let whole = parts.next().is_none() && hours.fract() == 0.0 && minutes.fract() == 0.0;
    (whole && minutes < 60.0 && seconds < 61.0).then_some(3600.0 * hours + 60.0 * minutes + seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of which the square is more than a test can wait for.
    const MANY: usize = 1_000_000;

    #[test]
    fn work_grows_with_the_rows_and_not_with_their_square() {
        let mut clock = Clock::of("time".to_owned());
        (0..MANY).for_each(|row| clock.push(&(row * 5).to_string()));
        let gaps = Vec::new();
        assert_eq!(clock.timebase(), Timebase::Rate { hz: 200.0, gaps });
    }
}
