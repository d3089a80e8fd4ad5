//! Scores of many recordings: per subject, then over subjects.
//!
//! Per subject: balanced accuracy = mean of the recalls over the samples of all recordings; raw accuracy = unweighted
//! mean over its recordings; transition accuracy = correct / events over all of them. Over subjects, a
//! [`Measure`](crate::Measure) has mean and sample standard deviation (n - 1), as in the reference's evaluation of ROAM-EMG.

use std::collections::BTreeMap;

use shared::intent::{Intent, MAX_CLASSES};

use super::balanced_accuracy::Recalls;
use super::offset::{self, OffsetSummary};
use super::transition;
use super::transition::{Rule, TransitionScore};
use crate::EvaluationError;
use recordings::statistics::MeanSd;

/// The scores of one recording.
#[derive(Clone, PartialEq, Debug)]
pub struct RecordingScore {
    /// Subject.
    pub subject: String,
    /// Whether each class is in the truth, scored or not.
    pub present: [bool; MAX_CLASSES],
    /// Samples of each class, and how many of them are right.
    pub recalls: Recalls,
    /// Raw accuracy; none without a true label.
    pub raw_accuracy: Option<f64>,
    /// Every true change, and whether the prediction follows it.
    pub transitions: TransitionScore,
}

impl RecordingScore {
    /// Scores one recording; samples after the last predicted one are not counted.
    pub fn new(
        subject: &str,
        truth: &[Option<Intent>],
        prediction: &[Option<Intent>],
        rule: &Rule,
    ) -> Result<Self, EvaluationError> {
        super::same_length(truth, prediction)?;
        let mut present = [false; MAX_CLASSES];
        for intent in truth.iter().flatten() {
            present[intent.class()] = true;
        }
        let length = super::predicted_length(prediction);
        let (truth, prediction) = (&truth[..length], &prediction[..length]);
        // The reference refuses a label of one sample, which has no room for a buffer; published annotations have them.
        let mut lasting = truth.to_vec();
        for at in 1..length.saturating_sub(1) {
            let [before, own, after] = [lasting[at - 1], lasting[at], lasting[at + 1]];
            let all = before.is_some() && own.is_some() && after.is_some();
            if all && own != before && own != after {
                lasting[at] = before;
            }
        }
        let recalls = Recalls::new(truth, prediction)?;
        Ok(Self {
            subject: subject.to_owned(),
            present,
            recalls,
            raw_accuracy: recalls.raw_accuracy(),
            transitions: transition::score(&lasting, prediction, rule)?,
        })
    }
}

/// The scores of one subject.
#[derive(Clone, PartialEq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct SubjectScore {
    /// Subject.
    pub subject: String,
    /// Number of recordings.
    pub recordings: usize,
    /// Number of classes in the truth of these recordings.
    pub classes: usize,
    /// Mean of the recalls of the classes that the subject's truth contains; none with fewer than two.
    pub balanced_accuracy: Option<f64>,
    /// Mean over the recordings that have true labels.
    pub raw_accuracy: Option<f64>,
    /// Changes that the prediction follows.
    pub correct: usize,
    /// Changes in the truth.
    pub events: usize,
    /// `correct / events`; none without a change.
    pub transition_accuracy: Option<f64>,
    /// Offset of each of these changes, in samples; medians over several subjects need all of them.
    pub offsets: Vec<i32>,
    /// Statistics of these offsets.
    pub offset: Option<OffsetSummary>,
}

/// The scores of all subjects.
#[derive(Clone, PartialEq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// Each subject, in alphabetical order.
    pub subjects: Vec<SubjectScore>,
    /// Changes that the prediction follows, of all subjects.
    pub correct: usize,
    /// Changes in the truth, of all subjects.
    pub events: usize,
    /// Statistics of the offsets of all subjects.
    pub offset: Option<OffsetSummary>,
}

impl Summary {
    /// Summary of the scores of subjects, each given once, in any order.
    pub fn of_subjects(mut subjects: Vec<SubjectScore>) -> Self {
        subjects.sort_by(|a, b| a.subject.cmp(&b.subject));
        let offsets: Vec<i32> = subjects.iter().flat_map(|s| s.offsets.clone()).collect();
        Self {
            correct: subjects.iter().map(|s| s.correct).sum(),
            events: subjects.iter().map(|s| s.events).sum(),
            offset: offset::summary(&offsets),
            subjects,
        }
    }
}

pub(crate) fn summary<'s>(scores: impl IntoIterator<Item = &'s RecordingScore>) -> Summary {
    let mut by_subject: BTreeMap<&str, Vec<&RecordingScore>> = BTreeMap::new();
    for score in scores {
        by_subject.entry(&score.subject).or_default().push(score);
    }
    let subjects = by_subject
        .into_iter()
        .map(|(subject, scores)| of_subject(subject, &scores))
        .collect();
    Summary::of_subjects(subjects)
}

/// Number of classes that are in any of the recordings.
fn classes<'a>(present: impl Iterator<Item = &'a [bool; MAX_CLASSES]>) -> usize {
    let all = present.fold([false; MAX_CLASSES], |all, own| {
        std::array::from_fn(|class| all[class] || own[class])
    });
    all.into_iter().filter(|&present| present).count()
}

fn of_subject(subject: &str, scores: &[&RecordingScore]) -> SubjectScore {
    let raw: Vec<f64> = scores.iter().filter_map(|s| s.raw_accuracy).collect();
    let recalls = scores.iter().map(|score| score.recalls);
    let recalls = recalls.fold(Recalls::default(), |sum, own| sum.plus(&own));
    let correct = scores.iter().map(|s| s.transitions.correct()).sum();
    let events = scores.iter().map(|s| s.transitions.events()).sum();
    let offsets: Vec<i32> = scores
        .iter()
        .flat_map(|s| s.transitions.offsets())
        .collect();
    SubjectScore {
        subject: subject.to_owned(),
        recordings: scores.len(),
        classes: classes(scores.iter().map(|score| &score.present)),
        balanced_accuracy: recalls.balanced_accuracy(),
        raw_accuracy: MeanSd::of(&raw).map(|r| r.mean),
        correct,
        events,
        transition_accuracy: (events > 0).then(|| correct as f64 / events as f64),
        offset: offset::summary(&offsets),
        offsets,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{O, R, labels};
    use crate::{Measure, Score};

    fn step(change: usize) -> Vec<Option<Intent>> {
        labels(&[(R, change), (O, 1000 - change)])
    }

    #[test]
    fn a_true_label_of_one_sample_counts_as_the_label_before_it() {
        let truth = labels(&[(R, 300), (O, 1), (R, 300), (None, 1), (O, 1), (R, 300)]);
        let score = RecordingScore::new("a", &truth, &truth, &Rule::default()).unwrap();
        let changes: Vec<usize> = score.transitions.changes.iter().map(|own| own.at).collect();
        assert_eq!(changes, [603]);
    }

    #[test]
    fn subjects_weigh_the_same_whatever_their_number_of_changes() {
        let score = |subject, late: usize| {
            let prediction = step(500 + late);
            RecordingScore::new(subject, &step(500), &prediction, &Rule::default()).unwrap()
        };
        let summary = summary(&[score("a", 0), score("a", 20), score("b", 300)]);
        assert_eq!((summary.correct, summary.events), (2, 3));
        assert_eq!(summary.subjects[0].raw_accuracy, Some(0.99));
        // 20 of the 1000 samples of the second class are wrong.
        assert_eq!(summary.subjects[0].balanced_accuracy, Some(0.99));
        assert_eq!(summary.offset.unwrap().signed.mean, 50.0);
        assert_eq!(summary.subjects[0].classes, 2);
        let score = Score::of_people(summary.subjects, Vec::new());
        let mean = |measure: Measure| measure.mean(&score).unwrap();
        assert_eq!(mean(Measure::TransitionAccuracy).mean, 0.5);
        assert_eq!(mean(Measure::BalancedAccuracy).n, 2);
    }

    #[test]
    fn samples_after_the_last_label_are_not_scored() {
        let mut prediction = step(500);
        prediction[950..].fill(None);
        let score = RecordingScore::new("a", &step(500), &prediction, &Rule::default()).unwrap();
        assert_eq!(score.raw_accuracy, Some(1.0));
        assert_eq!(score.transitions.correct(), 1);
        // A class of which no sample is scored is in the recording all the same.
        prediction[490..].fill(None);
        let score = RecordingScore::new("a", &step(500), &prediction, &Rule::default()).unwrap();
        assert_eq!(summary(&[score]).subjects[0].classes, 2);
    }
}
