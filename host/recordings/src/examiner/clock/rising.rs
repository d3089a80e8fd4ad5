//! Columns that rise from row to row, as times and counters do.

use shared::units::SAMPLE_RATE_HZ;

/// Largest deviation of an even step from the usual step, as a share of it.
const ALIKE: f64 = 0.2;
/// Rows over which a rate is averaged: times may come in bursts, or be whole seconds.
const AVERAGED: usize = 400;
/// Largest share of steps that go back in a column that rises: times may begin anew.
const BACK: f64 = 0.01;
/// Maximum mean number of rows from one rise of a column of times to the next; labels are held for longer.
const HELD: usize = 20;
/// Minimum number of rows that show that a column rises evenly.
const FEWEST: usize = 20;
/// Rows after which a counter begins anew: a second at most, since what begins anew later may be another recording.
const CYCLE: std::ops::RangeInclusive<usize> = 8..=SAMPLE_RATE_HZ as usize;

/// Whether values rise from row to row, as times and row numbers do, and nothing else for long.
pub(crate) fn rises(values: &[f64]) -> bool {
    let values = unwrapped(values);
    let steps = values.len().saturating_sub(1);
    let count = |of: fn(f64) -> bool| {
        let steps = values.windows(2).map(|pair| pair[1] - pair[0]);
        steps.filter(|step| of(*step)).count()
    };
    let (up, level) = (count(|step| step > 0.0), count(|step| step == 0.0));
    let back = steps - up - level;
    back as f64 <= BACK * steps as f64 && rises_often(up, steps)
}

/// Whether so many steps of a column of times go up.
pub(super) fn rises_often(up: usize, steps: usize) -> bool {
    up * HELD > steps
}

/// Whether values rise by the same from row to row, or over blocks of rows.
pub(crate) fn rises_evenly(values: &[f64]) -> bool {
    let values = unwrapped(values);
    let Some(period) = period(&values).filter(|period| *period > 0.0) else {
        return false;
    };
    let is_even = |rows: usize| {
        let ends: Vec<f64> = values.iter().step_by(rows).copied().collect();
        let is_even = |pair: &&[f64]| {
            let step = (pair[1] - pair[0]) / rows as f64;
            (step - period).abs() < ALIKE * period
        };
        10 * ends.windows(2).filter(is_even).count() >= 8 * (ends.len() - 1)
    };
    values.len() >= FEWEST && rises(&values) && (is_even(1) || is_even(averaged(values.len())))
}

/// Values of a counter that begins anew, without its beginnings; other values as they are.
pub(super) fn unwrapped(values: &[f64]) -> Vec<f64> {
    let mut base = 0.0;
    let Some(modulus) = modulus(values) else {
        return values.to_vec();
    };
    let mut before = f64::NEG_INFINITY;
    let unwrapped = values.iter().map(|&value| {
        base += if value < before { modulus } else { 0.0 };
        before = value;
        base + value
    });
    unwrapped.collect()
}

/// Number that a counter begins anew at, a power of two or that of a short cycle; none if it does not.
fn modulus(values: &[f64]) -> Option<f64> {
    let steps = || values.windows(2).map(|pair| pair[1] - pair[0]);
    let back = steps().filter(|step| *step < 0.0).count();
    let mut up: Vec<f64> = steps().filter(|step| *step > 0.0).collect();
    if back == 0 || up.len() <= back {
        return None;
    }
    let middle = up.len() / 2;
    let (_, step, _) = up.select_nth_unstable_by(middle, f64::total_cmp);
    let step = *step;
    let range = |(least, most): (f64, f64), &value: &f64| (least.min(value), most.max(value));
    let (least, most) = values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), range);
    let modulus = most - least + step;
    // A sawtooth of other steps is no counter.
    let begins_anew = |own: &f64| *own < 0.0 && (own + modulus - step).abs() < ALIKE * step;
    let anew = steps().filter(begins_anew).count();
    let cycle = (modulus / step).round() as usize;
    let is_binary = step == 1.0 && cycle > *CYCLE.start() && cycle.is_power_of_two();
    let is_short = back > 1 && CYCLE.contains(&cycle);
    (10 * anew >= 8 * back && (is_binary || is_short)).then_some(modulus)
}

/// Rows of a block over which times are averaged.
fn averaged(rows: usize) -> usize {
    (rows.saturating_sub(1) / 8).clamp(1, AVERAGED)
}

/// Usual step from row to row: the median of even steps, else the median over blocks of rows; none if a value is no
/// number or there are too few.
pub(super) fn period(times: &[f64]) -> Option<f64> {
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
    let rows = averaged(times.len());
    let ends = times.iter().step_by(rows);
    let mut steps: Vec<f64> = ends
        .clone()
        .zip(ends.skip(1))
        .map(|(from, to)| (to - from) / rows as f64)
        .collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rises_evenly_is_told_from_labels_and_muscle_activity() {
        let muscle = |row: usize| ((row * 37 + row / 7) % 29) as f64 - 14.0;
        let rises = |expected: bool, name: &str, value: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..1000).map(value).collect();
            assert_eq!(rises_evenly(&values), expected, "{name}");
        };
        rises(true, "seconds", &|row| row as f64 * 0.005);
        rises(true, "milliseconds, rounded", &|row| {
            (row as f64 * 5.05).round()
        });
        rises(true, "nanoseconds", &|row| 1.7e18 + row as f64 * 5e6);
        rises(true, "arrivals in twos", &|row| {
            (row / 2 * 10 + row / 2 * 31 % 8) as f64
        });
        rises(true, "a gap", &|row| {
            (row + if row > 500 { 3000 } else { 0 }) as f64
        });
        rises(true, "a counter of a hundred", &|row| (row % 100) as f64);
        rises(true, "from one on", &|row| (row % 50 + 1) as f64);
        rises(true, "a signed byte", &|row| {
            (row as u8).cast_signed().into()
        });
        rises(true, "seconds within a second", &|row| {
            (row % 200) as f64 * 0.005
        });
        rises(false, "sorted labels", &|row| (row / 100) as f64);
        rises(false, "a ramp and back", &|row| (500.0 - row as f64).abs());
        rises(false, "muscle activity", &muscle);
        rises(false, "nothing", &|_| 7.0);
    }
}
