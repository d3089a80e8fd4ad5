//! Label lag: how much later than its label the muscle acts, and labels compensated for it.
//!
//! Labels of the public sets are cues: people react 0.2 to 0.8 s after them. One constant per data
//! set, estimated on training people alone, shifts the labels to where the muscle usually acts.
//! It does not remove the spread between people, which is as large again.
//!
//! Rule: envelope e = mean over channels of ln(1 + moving average of |x| over 50 ms). For a change
//! between rest and a gesture, the levels before and after are the medians of e over the second
//! half of either run (there the muscle has settled in spite of the lag). The crossing is the first
//! sample from which e stays on the far side of the half-way level for 50 ms.

use std::ops::Range;

use shared::intent::Intent;
use shared::units::SAMPLE_PERIOD_MS;

use super::envelope::Envelope;
use super::runs::{Run, runs};
use crate::recording::{Recording, Timing};
use crate::statistics::median;

/// Samples of the moving average, and for which the envelope stays beyond the half-way level: 50 ms.
const SMOOTHING: usize = 10;
/// Samples before a label change that are searched for an early crossing: 0.5 s.
const EARLIEST: usize = 100;
/// Samples after a label change that are searched for a late crossing: 2 s, beyond the latest release (1.5 s, `ss-stm`
/// M8).
const LATEST: usize = 400;
/// Minimum difference of the levels (natural logarithm: a factor of 1.35); below it, noise decides
/// where the crossing is.
const LEAST_CONTRAST: f64 = 0.3;

/// Lag compensation of labels, which are cues: muscle activity follows them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LabelLag {
    /// Each cue's own lag, where rests around it show when the muscle followed; elsewhere as `estimated`.
    #[default]
    EachCue,
    /// Each data set's median lag, estimated on training people alone.
    Estimated,
    /// No compensation, as in the paper.
    None,
}

impl std::str::FromStr for LabelLag {
    type Err = serde::de::value::Error;

    /// Reads the name that presets use.
    fn from_str(name: &str) -> Result<Self, Self::Err> {
        use serde::{Deserialize as _, de::IntoDeserializer as _};
        Self::deserialize(name.into_deserializer())
    }
}

/// Median lag of the muscle after the label.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct LagEstimate {
    /// Median over changes from rest to a gesture, in ms; negative where the muscle comes first.
    pub onset_ms: f64,
    /// Median over changes from a gesture to rest, in ms.
    pub release_ms: f64,
    /// Median over both together, in samples, at least 0: the shift of lag-compensated labels.
    pub lag_samples: usize,
    /// Changes measured; those of weak contrast or without a crossing are left out.
    pub transitions: usize,
}

/// Estimates the lag over recordings of one data set; pass training subjects only.
///
/// The result is `None` if no change between rest and a gesture has a crossing, or if the labels are muscle onsets
/// themselves, which must not be moved by noise.
pub fn estimate(recordings: &[&Recording]) -> Option<LagEstimate> {
    let cued = |recording: &&&Recording| recording.timing != Timing::Muscle;
    let cued = recordings.iter().filter(cued);
    let changes: Vec<(bool, f64)> = cued.flat_map(|own| changes(own)).collect();
    let of = |onset| {
        let own = changes.iter().filter(move |(own, _)| *own == onset);
        own.map(|(_, lag)| *lag).collect::<Vec<f64>>()
    };
    let (onsets, releases) = (of(true), of(false));
    let pooled: Vec<f64> = onsets.iter().chain(&releases).copied().collect();
    let milliseconds = f64::from(SAMPLE_PERIOD_MS);
    let lag = median(&pooled)?;
    Some(LagEstimate {
        onset_ms: median(&onsets).unwrap_or(lag) * milliseconds,
        release_ms: median(&releases).unwrap_or(lag) * milliseconds,
        lag_samples: lag.round().max(0.0) as usize,
        transitions: pooled.len(),
    })
}

/// Lag-compensated labels: each is moved `lag_samples` later.
///
/// The first `lag_samples` had their label before the recording began: relax if the first label
/// is relax (rest goes on), else none, because the start of that gesture is unknown.
pub(crate) fn compensated(labels: &[Option<Intent>], lag_samples: usize) -> Vec<Option<Intent>> {
    let lag = lag_samples.min(labels.len());
    let first = labels.first().copied().flatten();
    let start = first.filter(|&label| label == Intent::Relax);
    let mut compensated = vec![start; lag];
    compensated.extend_from_slice(&labels[..labels.len() - lag]);
    compensated
}

/// A range of samples of a recording of `length` samples, moved `lag_samples` later.
pub(crate) fn compensated_range(
    range: &Range<usize>,
    lag_samples: usize,
    length: usize,
) -> Range<usize> {
    let [start, end] = [range.start, range.end].map(|at| (at + lag_samples).min(length));
    start..end
}

/// Samples by which the muscle follows each change between rest and a gesture.
pub(super) fn lags_of(recording: &Recording) -> impl Iterator<Item = f64> {
    changes(recording).into_iter().map(|(_, lag)| lag)
}

/// Every change between rest and a gesture that the muscle shows: whether it is an onset, and its lag in samples.
fn changes(recording: &Recording) -> Vec<(bool, f64)> {
    let envelope = Envelope::new(&recording.samples).all(SMOOTHING);
    let lag = |pair: &[Run]| {
        let onset = match (pair[0].label, pair[1].label) {
            (Some(Intent::Relax), Some(_)) => true,
            (Some(_), Some(Intent::Relax)) => false,
            _ => return None,
        };
        Some((onset, lag_of(&envelope, &pair[0], &pair[1])?))
    };
    runs(&recording.labels).windows(2).filter_map(lag).collect()
}

/// Samples by which the muscle follows the change between two runs; negative if it comes first.
fn lag_of(envelope: &[f64], before: &Run, after: &Run) -> Option<f64> {
    let level = |run: &Run| median(&envelope[run.middle()..run.end]);
    let (from, to) = (level(before)?, level(after)?);
    if (to - from).abs() < LEAST_CONTRAST {
        return None;
    }
    let half_way = f64::midpoint(from, to);
    let beyond = |sample: usize| (envelope[sample] > half_way) == (to > from);

    let change = after.start;
    let first = change.saturating_sub(EARLIEST).max(before.start);
    let last = (change + LATEST).min(after.end).checked_sub(SMOOTHING)?;
    if first > last || beyond(first) {
        return None;
    }
    let crossing = (first..=last).find(|&at| (at..at + SMOOTHING).all(beyond))?;
    Some(crossing as f64 - change as f64)
}

#[cfg(test)]
pub(super) mod tests {
    use shared::units::CHANNELS;

    use super::*;
    use crate::catalogue::DataSet;
    use crate::fixture::{C, R, labels, muscle};

    /// Rest and closing in turn, 200 samples each; the muscle follows `late` samples later.
    pub(crate) fn recording(late: usize) -> Recording {
        let labels = labels(&[(R, 200), (C, 200)].repeat(5));
        let loud = (200..2000).step_by(400);
        let loud: Vec<_> = loud.map(|cue| cue + late..cue + 200 + late).collect();
        let samples = muscle(labels.len(), &loud);
        Recording::new(DataSet::SYNTHETIC, "s", samples, labels)
    }

    #[test]
    fn a_constant_lag_is_found_to_within_the_smoothing() {
        for late in [0, 20, 70] {
            let lag = estimate(&[&recording(late)]).unwrap();
            let is_near = lag.lag_samples.abs_diff(late) <= SMOOTHING / 2;
            assert!(is_near, "{late}: {lag:?}");
            assert_eq!(lag.transitions, 9);
        }
    }

    #[test]
    fn without_contrast_or_with_onsets_of_the_muscle_there_is_no_estimate() {
        let (mut quiet, mut onsets) = (recording(20), recording(20));
        quiet.samples.fill([3; CHANNELS]);
        onsets.timing = Timing::Muscle;
        for recordings in [&[&quiet][..], &[&onsets], &[]] {
            assert_eq!(estimate(recordings), None);
        }
    }

    #[test]
    fn compensated_labels_start_with_rest_or_with_nothing() {
        assert_eq!(compensated(&[R, C, C, R], 2), [R, R, R, C]);
        assert_eq!(compensated(&[C, R, R], 1), [None, C, R]);
        assert_eq!(compensated(&[C, R], 9), [None, None]);
        assert_eq!(compensated(&[C, R], 0), [C, R]);
        assert!(compensated(&[], 3).is_empty());
    }
}
