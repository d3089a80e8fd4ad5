//! Labels from muscle activity, for recordings of one gesture that are published without times.
//!
//! One rule for all such sets; e is the envelope over 200 ms unless another width is said:
//!
//! 1. Levels: quiet and loud are the 10 % and 90 % quantiles of e in the recording, half-way lies between
//!    them. With a contrast (loud - quiet) below 0.4, a factor of 1.5, nothing is labelled.
//! 2. Bursts: stretches with e above half-way; gaps below 0.3 s between two are closed. Those below 0.4 s
//!    are dropped and stay unknown.
//! 3. Edges: e over 200 ms finds a burst but widens it by 20 to 30 ms at either edge. The onset is
//!    moved to the first sample from which e over 50 ms stays above half-way for 50 ms, at most 100 ms away; the
//!    release likewise, backwards in time.
//! 4. Slow edges: where e takes longer than 0.5 s from a quarter to three quarters of the burst's own
//!    contrast (its median against quiet), what is between is unknown.
//! 5. The gesture inside a burst, relax outside.
//!
//! A recording must be quiet and active for a tenth of its duration each. The labels are
//! muscle onsets and not cues: such sets have no label lag.

use std::ops::Range;

use shared::units::Sample;

use super::envelope::Envelope;
use super::motion::{GroundTruth, Motion};
use crate::statistics::median;

/// Samples of the moving average that finds bursts: 200 ms.
const COARSE: usize = 40;
/// Samples of the moving average that places the edges of bursts, and for which it stays beyond half-way: 50 ms.
const FINE: usize = 10;
/// Maximum number of samples by which an edge is moved: half of [`COARSE`].
const REACH: usize = COARSE / 2;
/// Share of the recording below the quiet level, and above the loud one.
const TAIL: f64 = 0.1;
/// Minimum contrast (natural logarithm). Noise alone has 0.06 to 0.16 (`epn`, no gesture), the weakest file of
/// `wang-myo` 0.88.
const LEAST_CONTRAST: f64 = 0.4;
/// Samples of a gap that is closed: below 0.3 s.
const GAP: usize = 60;
/// Minimum length of a burst in samples: 0.4 s.
const BURST: usize = 80;
/// Maximum length in samples of an edge that is taken for an instant: 0.5 s.
const EDGE: usize = 100;

/// Note of a recording that cannot be labelled.
pub(crate) const WEAK: &str = "unlabelled: the muscle hardly rises above rest";

/// Activity of the muscle at one sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Activity {
    Quiet,
    Active,
    Uncertain,
}

/// Labels samples of one motion: relax where the muscle is quiet, `motion` where it is active.
///
/// The result is `None` if the contrast is too weak.
pub(crate) fn label(samples: &[Sample], motion: Motion) -> Option<GroundTruth> {
    let motions = activity(samples)?
        .into_iter()
        .map(|activity| match activity {
            Activity::Quiet => Motion::RELAX,
            Activity::Active => motion,
            Activity::Uncertain => Motion::Unknown,
        });
    Some(motions.collect())
}

/// Activity of the muscle at each sample; none if the contrast is too weak.
pub(crate) fn activity(samples: &[Sample]) -> Option<Vec<Activity>> {
    let envelope = Envelope::new(samples);
    let coarse = envelope.all(COARSE);
    let levels = Levels::of(&coarse)?;
    let mut activity = vec![Activity::Quiet; samples.len()];
    let bursts = bursts(&coarse, levels.half_way());
    for (index, burst) in bursts.iter().enumerate() {
        // The edges of a burst stay out of its neighbours.
        let before = index.checked_sub(1).map_or(0, |i| bursts[i].end);
        let after = bursts.get(index + 1).map_or(samples.len(), |b| b.start);
        let loud = median(&coarse[burst.clone()])?;
        let low = levels.quiet + 0.25 * (loud - levels.quiet);
        let high = levels.quiet + 0.75 * (loud - levels.quiet);
        let quiet = |at: &usize| coarse[*at] < low;
        let loud = |at: &usize| coarse[*at] >= high;
        let rise_from = (before..burst.start)
            .rev()
            .find(quiet)
            .map_or(before, |at| at + 1);
        let fall_to = (burst.end..after).find(quiet).unwrap_or(after);
        if burst.len() < BURST {
            activity[rise_from..fall_to].fill(Activity::Uncertain);
            continue;
        }
        let onset = onset(&envelope, levels.half_way(), burst.start);
        let release = release(&envelope, levels.half_way(), burst.end, samples.len());
        activity[onset..release].fill(Activity::Active);
        let rise_to = burst.clone().find(loud).unwrap_or(burst.end);
        let fall_from = burst
            .clone()
            .rev()
            .find(loud)
            .map_or(burst.start, |at| at + 1);
        for (inside, edge) in [
            (burst.start > 0, rise_from..rise_to),
            (burst.end < samples.len(), fall_from..fall_to),
        ] {
            if inside && edge.len() > EDGE {
                activity[edge].fill(Activity::Uncertain);
            }
        }
    }
    Some(activity)
}

/// Quiet and loud level of a recording's envelope.
struct Levels {
    quiet: f64,
    loud: f64,
}

impl Levels {
    /// Levels of an envelope; none if the contrast is too weak or there is no sample.
    fn of(coarse: &[f64]) -> Option<Self> {
        let mut sorted = coarse.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let last = sorted.len().checked_sub(1)?;
        let quantile = |share: f64| sorted[(share * last as f64).round() as usize];
        let (quiet, loud) = (quantile(TAIL), quantile(1.0 - TAIL));
        (loud - quiet >= LEAST_CONTRAST).then_some(Self { quiet, loud })
    }

    const fn half_way(&self) -> f64 {
        f64::midpoint(self.quiet, self.loud)
    }
}

/// Stretches above a level, short gaps closed.
fn bursts(coarse: &[f64], level: f64) -> Vec<Range<usize>> {
    let mut bursts: Vec<Range<usize>> = Vec::new();
    for (at, _) in coarse.iter().enumerate().filter(|(_, e)| **e > level) {
        match bursts.last_mut() {
            Some(last) if at - last.end < GAP => last.end = at + 1,
            _ => bursts.push(at..at + 1),
        }
    }
    bursts
}

/// Start of a burst by the finer envelope; unchanged at the start of the recording, or if the finer envelope does not
/// cross within reach.
fn onset(envelope: &Envelope, level: f64, start: usize) -> usize {
    let above = |at: usize| envelope.at(at, FINE) > level;
    let Some(first) = start.checked_sub(REACH) else {
        return start;
    };
    (first..=start + REACH)
        .find(|&at| (at..at + FINE).all(above))
        .filter(|&at| at > first)
        .unwrap_or(start)
}

/// End of a burst by the finer envelope: [`onset`] backwards.
fn release(envelope: &Envelope, level: f64, end: usize, samples: usize) -> usize {
    let above = |at: usize| envelope.at(at, FINE) > level;
    let last = end + REACH;
    if last > samples {
        return end;
    }
    (end - REACH..=last)
        .rev()
        .find(|&at| (at - FINE..at).all(above))
        .filter(|&at| at < last)
        .unwrap_or(end)
}

#[cfg(test)]
#[expect(
    clippy::single_range_in_vec_init,
    reason = "a list of ranges, one of them"
)]
mod tests {
    use proptest::prelude::*;
    use shared::intent::Intent;

    use super::*;
    use crate::fixture::{muscle, noise};
    use crate::labels::runs::runs;
    use crate::recording::movement::MovementKind;

    fn active(samples: &[Sample]) -> Vec<Range<usize>> {
        let truth = label(samples, Motion::Intent(Intent::Close)).expect("contrast");
        runs(&truth.labels)
            .iter()
            .filter(|run| run.label == Some(Intent::Close))
            .map(|run| run.start..run.end)
            .collect()
    }

    fn unknown(samples: &[Sample]) -> usize {
        let truth = label(samples, Motion::RELAX).expect("contrast");
        truth.labels.iter().filter(|label| label.is_none()).count()
    }

    /// Whether edges are found to within 50 ms.
    fn close_to(found: &[Range<usize>], expected: &[Range<usize>]) -> bool {
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(found, expected)| {
                found.start.abs_diff(expected.start) <= FINE
                    && found.end.abs_diff(expected.end) <= FINE
            })
    }

    #[test]
    fn a_hold_cut_by_an_end_reaches_to_it() {
        let expected = [0..500, 1300..2000];
        let found = active(&muscle(2000, &expected));
        assert!(close_to(&found, &expected), "{found:?}");
        assert_eq!((found[0].start, found[1].end), (0, 2000));
    }

    #[test]
    fn short_gaps_are_closed_and_long_ones_are_rest() {
        let samples = muscle(2400, &[400..700, 735..1000, 1200..1600]);
        let found = active(&samples);
        assert!(close_to(&found, &[400..1000, 1200..1600]), "{found:?}");
        // Edges of an instant leave nothing unknown.
        assert_eq!(unknown(&samples), 0);
    }

    #[test]
    fn a_short_burst_is_neither_gesture_nor_rest() {
        let samples = muscle(2400, &[400..900, 1400..1440]);
        let truth = label(&samples, Motion::Intent(Intent::Close)).unwrap();
        assert!(close_to(&active(&samples), &[400..900]));
        assert!(truth.labels[1400..1440].iter().all(Option::is_none));
        let unknown = unknown(&samples);
        assert!((40..120).contains(&unknown), "{unknown}");
    }

    #[test]
    fn a_slow_release_is_unknown_until_rest() {
        // From the hold down to rest, in the logarithm, within 2 s.
        let fall = (3.0_f64 / 40.0).ln();
        let amplitude = |at: usize| match at {
            500..1000 => 40.0,
            1000..1400 => 40.0 * (fall * (at - 1000) as f64 / 400.0).exp(),
            _ => 3.0,
        };
        let samples = noise(2000, 2, amplitude);
        let truth = label(&samples, Motion::Intent(Intent::Open)).unwrap();
        let found: Vec<_> = runs(&truth.labels).iter().map(|run| run.label).collect();
        let relax = Some(Intent::Relax);
        assert_eq!(found, [relax, Some(Intent::Open), None, relax]);
        let unknown = unknown(&samples);
        assert!((100..300).contains(&unknown), "{unknown}");
    }

    #[test]
    fn without_contrast_nothing_is_labelled() {
        let noises = [noise(2000, 3, |_| 5.0), noise(2000, 3, |_| 60.0)];
        for samples in noises.into_iter().chain([vec![], vec![[100; 8]; 7]]) {
            assert_eq!(label(&samples, Motion::Other(MovementKind::Point)), None);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        /// Any schedule of holds and rests that the rule's limits allow comes out as it went in.
        #[test]
        fn every_schedule_within_the_limits_is_found(
            lengths in proptest::collection::vec((160_usize..700, 160_usize..700), 2..12),
            amplitude in 12.0_f64..120.0,
            seed: u64,
        ) {
            let mut expected = Vec::new();
            let mut end = 0;
            for (rest, hold) in lengths {
                expected.push(end + rest..end + rest + hold);
                end += rest + hold;
            }
            let count = end + 200;
            let hold = |at: usize| expected.iter().any(|hold| hold.contains(&at));
            let samples = noise(count, seed, |at| if hold(at) { amplitude } else { 3.0 });
            let found = active(&samples);
            prop_assert!(close_to(&found, &expected), "{found:?}\n{expected:?}");
        }
    }
}
