//! Format of numbers in tables, the same in every table.

use crate::Difference;
use crate::metric::event::latency::{Latency, LatencySummary};
use recordings::statistics::{Interval, MeanSd};

/// Cell of a missing number.
pub fn none() -> String {
    "-".to_owned()
}

/// A number with its noun: `1 subject`, `2 subjects`.
pub fn number_of(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Adds the number of people where the row has another one: `0.912 [0.88, 0.94] n 29`.
pub fn of_people(cell: String, people: usize, of_row: usize) -> String {
    if people == of_row || cell == none() {
        return cell;
    }
    format!("{cell} n {people}")
}

/// A share of 1 over subjects: mean with three digits, deviation with two.
pub(crate) fn share(value: Option<MeanSd>) -> String {
    spread(value, 3, 2)
}

/// A share of 1 over subjects: mean with three digits, 95 % interval of the mean with two.
pub fn estimate(mean: Option<MeanSd>, interval: Option<Interval>) -> String {
    let Some(value) = mean else { return none() };
    let interval = interval.map(|ends| format!(" [{:.2}, {:.2}]", ends.low, ends.high));
    format!("{:.3}{}", value.mean, interval.unwrap_or_default())
}

/// A share in 14 columns, with its 95 % interval: `0.76 (.70-.81)`.
pub(crate) fn narrow_estimate(mean: Option<MeanSd>, interval: Option<Interval>) -> String {
    let Some(value) = mean else { return none() };
    let end = |value: f64| match format!("{value:.2}").strip_prefix('0') {
        Some(decimals) => decimals.to_owned(),
        None => format!("{value:.1}"),
    };
    let interval = interval.map(|ends| format!(" ({}-{})", end(ends.low), end(ends.high)));
    format!("{:.2}{}", value.mean, interval.unwrap_or_default())
}

/// Events a minute, mean over subjects.
pub(crate) fn rate(value: Option<MeanSd>) -> String {
    spread(value, 1, 1)
}

/// Median and 90th percentile of a latency in ms, `285 / 610`. Where one falls on a missed gesture, the share that is
/// missed at least: `285 / >10 % missed`, `>50 % missed`.
pub fn latency(value: Option<LatencySummary>) -> String {
    match value {
        None => none(),
        Some(own) if own.median == Latency::Missed => median(own),
        Some(own) => format!("{} / {}", median(own), p90(own)),
    }
}

/// Median of a latency in ms.
pub(crate) fn median(of: LatencySummary) -> String {
    quantile(of.median, ">50 % missed")
}

/// Median of a latency in ms, in 6 columns.
pub(crate) fn narrow_median(of: LatencySummary) -> String {
    quantile(of.median, "missed")
}

/// 90th percentile of a latency in ms.
pub(crate) fn p90(of: LatencySummary) -> String {
    quantile(of.p90, ">10 % missed")
}

fn quantile(value: Latency, missed: &str) -> String {
    match value {
        Latency::Ms(milliseconds) => whole(milliseconds),
        Latency::Missed => missed.to_owned(),
    }
}

/// Latency in a sentence: `half within 285 ms, nine in ten within 610 ms`.
pub(crate) fn latency_in_words(LatencySummary { median, p90 }: LatencySummary) -> String {
    let Latency::Ms(median) = median else {
        return "more than half missed".to_owned();
    };
    let rest = match p90 {
        Latency::Ms(p90) => format!("nine in ten within {} ms", whole(p90)),
        Latency::Missed => "more than one in ten missed".to_owned(),
    };
    format!("half within {} ms, {rest}", whole(median))
}

/// A difference of shares: `+0.120 [+0.030, +0.210] n 8`, and in words if no difference is shown.
pub fn difference(value: Option<Difference>) -> String {
    let Some(value) = value else { return none() };
    // What rounds to zero has no minus.
    let signed = |value: f64| format!("{:+.3}", (value * 1000.0).round() / 1000.0 + 0.0);
    let mean = signed(value.mean.mean);
    let interval = value
        .interval
        .map(|ends| format!(" [{}, {}]", signed(ends.low), signed(ends.high)));
    let interval = interval.unwrap_or_default();
    let words = match value.is_shown() {
        true => "",
        false => ", no difference shown",
    };
    format!("{mean}{interval} n {}{words}", value.mean.n)
}

/// Mean and deviation with so many decimals.
fn spread(value: Option<MeanSd>, decimals: usize, of_deviation: usize) -> String {
    let Some(value) = value else { return none() };
    let deviation = value.sd.map(|sd| format!(" ({sd:.of_deviation$})"));
    format!("{:.decimals$}{}", value.mean, deviation.unwrap_or_default())
}

fn whole(value: f64) -> String {
    format!("{:.0}", value.round())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_alike_in_every_table() {
        let both = MeanSd {
            mean: 0.9116,
            sd: Some(0.044),
            n: 8,
        };
        let one = MeanSd { sd: None, ..both };
        assert_eq!(share(Some(both)), "0.912 (0.04)");
        assert_eq!(share(Some(one)), "0.912");
        assert_eq!(share(None), none());
        let (low, high) = (0.8811, 0.94);
        let interval = Some(Interval { low, high });
        assert_eq!(estimate(Some(both), interval), "0.912 [0.88, 0.94]");
        assert_eq!(estimate(Some(one), None), "0.912");
        let (low, high) = (0.0, 1.0);
        let whole = Some(Interval { low, high });
        assert_eq!(narrow_estimate(Some(both), whole), "0.91 (.00-1.0)");
        assert_eq!(narrow_estimate(Some(both), interval), "0.91 (.88-.94)");
        assert_eq!(of_people(share(Some(both)), 8, 8), share(Some(both)));
        assert_eq!(of_people(share(Some(both)), 8, 9), "0.912 (0.04) n 8");
        assert_eq!(of_people(none(), 0, 9), none());
    }

    #[test]
    fn a_latency_that_falls_on_a_missed_gesture_says_how_many_are_missed_at_least() {
        let of = |median, p90| LatencySummary { median, p90 };
        let (ms, missed) = (Latency::Ms, Latency::Missed);
        for (value, shown) in [
            (of(ms(260.0), ms(610.0)), "260 / 610"),
            (of(ms(260.0), missed), "260 / >10 % missed"),
            (of(missed, missed), ">50 % missed"),
        ] {
            assert_eq!(latency(Some(value)), shown);
        }
        assert_eq!(latency(None), none());
    }

    #[test]
    fn a_difference_whose_interval_contains_zero_is_not_shown() {
        let of = |mean, interval: Option<(f64, f64)>| {
            let (sd, n) = (None, 8);
            difference(Some(Difference {
                mean: MeanSd { mean, sd, n },
                interval: interval.map(|(low, high)| Interval { low, high }),
            }))
        };
        for (mean, interval, shown) in [
            (0.0116, Some((0.003, 0.02)), "+0.012 [+0.003, +0.020] n 8"),
            (
                0.0116,
                Some((-0.003, 0.02)),
                "+0.012 [-0.003, +0.020] n 8, no difference shown",
            ),
            // What rounds to zero has no minus.
            (-0.0004, None, "+0.000 n 8, no difference shown"),
        ] {
            assert_eq!(of(mean, interval), shown);
        }
    }
}
