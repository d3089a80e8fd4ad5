//! Transition accuracy = changes of the truth that the prediction follows / changes of the truth.
//!
//! The prediction follows a change if, within a buffer around it, it goes from the old label A to the
//! new label B and shows nothing else, and then stays B up to the next buffer (the maintenance).
//!
//! Source: ReactEMG (arXiv 2506.19815) and its released evaluation code, special cases included: the
//! results are equal on all of the reference's cases (tests/golden/transition.rs).

mod status;

use std::ops::Range;

use shared::intent::Intent;

use super::{by_name, same_length, stretches};
use crate::EvaluationError;
pub use status::TransitionStatus;
use status::status;

/// A predicted or true label; none: nothing emitted, or unknown.
type Label = Option<Intent>;

/// The rule that decides whether the prediction follows a change from label A to label B.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Rule {
    /// Width of the buffer in samples, both sides together; half of it lies on each side.
    pub buffer: usize,
    /// Once B has been predicted, nothing but B may follow; and the buffer may not start with B.
    pub strict: bool,
    /// Relax is also allowed, in the buffer and in the maintenance.
    pub allow_relax: bool,
}

impl Default for Rule {
    /// The paper's rule: half a second on each side, not strict, relax not allowed.
    fn default() -> Self {
        Self {
            buffer: 200,
            strict: false,
            allow_relax: false,
        }
    }
}

/// One change of the truth. All positions are samples of the whole sequence.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Change {
    /// First sample of the new label.
    pub at: usize,
    /// Name of the old label.
    #[serde(serialize_with = "by_name")]
    pub from: Intent,
    /// Name of the new label.
    #[serde(serialize_with = "by_name")]
    pub to: Intent,
    /// Buffer: where the prediction has to change.
    pub buffer: Range<usize>,
    /// Maintenance: where it has to hold; may be empty.
    pub maintenance: Range<usize>,
    /// Whether the prediction follows, or why not.
    pub status: TransitionStatus,
    /// Predicted minus true time in samples, if the prediction follows; positive: late.
    pub offset: Option<i32>,
}

/// All changes of one truth.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct TransitionScore {
    /// Changes in order of time.
    pub changes: Vec<Change>,
    /// Labelled stretches without any change, and how many of them are predicted without an error.
    /// They do not enter the accuracy.
    pub constant: ConstantStretches,
}

/// Labelled stretches without a change.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct ConstantStretches {
    /// Number of stretches.
    pub count: usize,
    /// Number of stretches predicted correctly at every sample.
    pub held: usize,
}

impl TransitionScore {
    /// Changes in the truth.
    pub const fn events(&self) -> usize {
        self.changes.len()
    }

    /// Changes that the prediction follows.
    pub fn correct(&self) -> usize {
        self.changes
            .iter()
            .filter(|change| change.status == TransitionStatus::Ok)
            .count()
    }

    /// `correct / events`; none without a change.
    pub fn accuracy(&self) -> Option<f64> {
        (self.events() > 0).then(|| self.correct() as f64 / self.events() as f64)
    }

    /// Signed offsets, in samples, of the changes that have one.
    pub fn offsets(&self) -> impl Iterator<Item = i32> {
        self.changes.iter().filter_map(|change| change.offset)
    }
}

/// Checks every change of the truth.
///
/// Each labelled stretch of the truth is scored as a recording of its own.
///
/// # Errors
/// [`EvaluationError::Length`] if the sequences differ in length; [`EvaluationError::NarrowBuffer`] below
/// 2 samples;
/// [`EvaluationError::SingleSampleLabel`] if a true label between two changes lasts one sample.
pub fn score(
    truth: &[Label],
    prediction: &[Label],
    rule: &Rule,
) -> Result<TransitionScore, EvaluationError> {
    same_length(truth, prediction)?;
    if rule.buffer < 2 {
        return Err(EvaluationError::NarrowBuffer(rule.buffer));
    }
    let mut score = TransitionScore::default();
    for stretch in stretches(truth) {
        let truth: Vec<Intent> = truth[stretch.clone()].iter().copied().flatten().collect();
        let prediction = &prediction[stretch.clone()];
        let windows = Windows::new(&truth, rule.buffer);
        if windows.changes.is_empty() {
            score.constant.count += 1;
            let held = truth.iter().zip(prediction).all(|(&t, &p)| p == Some(t));
            score.constant.held += usize::from(held);
        }
        for index in 0..windows.changes.len() {
            let mut change = check(&truth, prediction, &windows, index, rule)
                .map_err(|at| EvaluationError::SingleSampleLabel(stretch.start + at))?;
            change.at += stretch.start;
            for range in [&mut change.buffer, &mut change.maintenance] {
                *range = range.start + stretch.start..range.end + stretch.start;
            }
            score.changes.push(change);
        }
    }
    Ok(score)
}

/// Checks one change; the error is the first sample of a label too short to have a buffer.
fn check(
    truth: &[Intent],
    prediction: &[Label],
    windows: &Windows,
    index: usize,
    rule: &Rule,
) -> Result<Change, usize> {
    let at = windows.changes[index];
    let (buffer, maintenance) = (&windows.buffers[index], &windows.maintenance[index]);
    if !buffer.contains(&at) || buffer.start == at {
        return Err(at);
    }
    let (from, to) = (truth[at - 1], truth[at]);
    let near = &prediction[buffer.clone()];
    let later = &prediction[maintenance.clone()];
    let status = status(from, to, near, later, rule);
    let offset = (status == TransitionStatus::Ok)
        .then(|| offset(prediction, at, Some(from), Some(to), rule.buffer / 2))
        .flatten();
    Ok(Change {
        at,
        from,
        to,
        buffer: buffer.clone(),
        maintenance: maintenance.clone(),
        status,
        offset,
    })
}

/// Offset of the nearest predicted change from A to B within half a buffer of the true one, the earliest on ties.
fn offset(prediction: &[Label], at: usize, from: Label, to: Label, half: usize) -> Option<i32> {
    let last_old = at - 1;
    let range = last_old.saturating_sub(half)..(prediction.len() - 1).min(last_old + half);
    let distance = |sample: usize| sample as i32 - last_old as i32;
    let straight = range
        .clone()
        .filter(|&i| prediction[i] == from && prediction[i + 1] == to)
        .map(distance)
        .min_by_key(|offset| offset.abs());
    // No direct change occurs only where relax lies between A and B: then the first B counts, as in the reference.
    straight.or_else(|| range.clone().find(|&i| prediction[i] == to).map(distance))
}

/// Buffers and maintenance intervals of one labelled stretch.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Windows {
    /// First sample of every new label.
    pub changes: Vec<usize>,
    /// The buffer of each change.
    pub buffers: Vec<Range<usize>>,
    /// The interval from each buffer to the next; without any change, the whole stretch.
    pub maintenance: Vec<Range<usize>>,
}

impl Windows {
    /// Buffers of `width` samples, half of it on each side of a change, and the intervals between them.
    ///
    /// A buffer starts no earlier than the one before it ends. Where the next change is near, it stops one sample
    /// *before* the last sample of its label. Both rules are the reference's.
    pub fn new(truth: &[Intent], width: usize) -> Self {
        let half = width / 2;
        let samples = truth.len();
        let changes: Vec<usize> = (1..samples)
            .filter(|&at| truth[at] != truth[at - 1])
            .collect();
        let mut buffers: Vec<Range<usize>> = Vec::with_capacity(changes.len());
        for (index, &change) in changes.iter().enumerate() {
            let before = buffers.last().map_or(0, |buffer| buffer.end);
            let start = change.saturating_sub(half).max(before);
            let end = (change + half).min(samples);
            let end = match changes.get(index + 1) {
                Some(&next) if next <= end => next - 1,
                _ => end,
            };
            buffers.push(start..end);
        }
        let maintenance = if buffers.is_empty() {
            std::iter::once(0..samples).collect()
        } else {
            let next_starts = buffers.iter().skip(1).map(|b| b.start).chain([samples]);
            buffers
                .iter()
                .zip(next_starts)
                .map(|(buffer, next)| buffer.end..next)
                .collect()
        };
        Self {
            changes,
            buffers,
            maintenance,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{C, O, R, labels};

    #[test]
    fn unlabelled_stretches_divide_the_truth() {
        let parts = [
            [(R, 300), (O, 300), (None, 200)],
            [(R, 300), (C, 300), (None, 10)],
        ];
        let truth = labels(&parts.concat());
        let prediction = labels(&[(R, 310), (O, 490), (R, 290), (C, 320)]);
        let score = score(&truth, &prediction, &Rule::default()).unwrap();
        let changes = score.changes.iter();
        let found = changes.map(|own| (own.at, own.offset, own.maintenance.end));
        assert!(found.eq([(300, Some(10), 600), (1100, Some(-10), 1400)]));
        assert_eq!(score.accuracy(), Some(1.0));
    }

    #[test]
    fn a_truth_of_one_label_is_no_event() {
        let score = score(&[R; 50], &[R; 50], &Rule::default()).unwrap();
        assert_eq!((score.events(), score.accuracy()), (0, None));
        assert_eq!(score.constant, ConstantStretches { count: 1, held: 1 });
    }

    #[test]
    fn a_label_of_one_sample_is_refused_with_its_place() {
        let truth = labels(&[(R, 300), (O, 1), (R, 300)]);
        let refused = score(&truth, &truth, &Rule::default());
        assert!(matches!(
            refused,
            Err(EvaluationError::SingleSampleLabel(300))
        ));
    }

    proptest::proptest! {
        #[test]
        fn any_sequences_are_scored_or_refused(
            labels in proptest::collection::vec((0..4usize, 0..4usize), 1..200),
            buffer in 0..80usize,
            strict: bool,
            allow_relax: bool,
        ) {
            let intent = |class| if class == 3 { None } else { Intent::from_class(class) };
            let (truth, prediction): (Vec<_>, Vec<_>) =
                labels.into_iter().map(|(t, p)| (intent(t), intent(p))).unzip();
            let _ = score(&truth, &prediction, &Rule { buffer, strict, allow_relax });
        }
    }
}
