//! Scores of any predicted label sequence against the true one: every metric, of one recording.

mod words;

use recordings::labels::motion::GroundTruth;
use recordings::labels::vocabulary;
use recordings::movement;
use shared::intent::Intent;

use crate::EvaluationError;
use crate::metric::confusion::Confusion;
use crate::metric::event::RecordingEvents;
use crate::metric::predicted_length;
use crate::metric::summary::RecordingScore;
use crate::metric::transition::Rule;

/// Scores of both times of a label.
#[derive(Clone, Debug)]
pub struct LabelScore {
    /// Labels at the times that they are for.
    pub reference: RecordingScore,
    /// Labels at the times when they are emitted.
    pub emission: RecordingScore,
    /// Events, of labels when they are emitted.
    pub events: RecordingEvents,
    /// Samples by true and predicted label.
    pub confusion: Confusion,
    /// Samples after the last prediction, which are not scored.
    pub unscored: usize,
    rule: Rule,
}

/// Times when labels are emitted.
#[derive(Clone, Debug)]
pub enum Emission {
    /// Label of each sample when it is emitted.
    Labels(Vec<Option<Intent>>),
    /// Number of samples after the place of the label.
    After(usize),
}

impl Emission {
    /// Label of each sample when it is emitted, of labels at the times that they are for.
    pub fn labels(self, reference: &[Option<Intent>]) -> Vec<Option<Intent>> {
        match self {
            Self::Labels(emitted) => emitted,
            Self::After(samples) => delayed(reference, samples),
        }
    }
}

impl LabelScore {
    /// Scores predicted labels, one a sample, against the truth.
    ///
    /// # Errors
    /// When the two differ in length, or a label or the rule's buffer cannot be scored.
    pub fn new(
        truth: &GroundTruth,
        prediction: &[Option<Intent>],
        emission: Emission,
        rule: Rule,
    ) -> Result<Self, EvaluationError> {
        let labels = &truth.labels;
        let reference = RecordingScore::new("", labels, prediction, &rule)?;
        let mut confusion = Confusion::new(vocabulary::smallest(labels.iter().chain(prediction)));
        let scored = predicted_length(prediction);
        let (own, prediction) = (&labels[..scored], &prediction[..scored]);
        confusion.add(own, prediction)?;
        let mut emitted = emission.labels(prediction);
        emitted.truncate(scored);
        let movements = movement::within(&truth.other_movement, &(0..scored));
        Ok(Self {
            emission: RecordingScore::new("", own, &emitted, &rule)?,
            events: RecordingEvents::new(own, &emitted, &movements)?,
            reference,
            confusion,
            unscored: labels.len() - scored,
            rule,
        })
    }
}

fn delayed(labels: &[Option<Intent>], samples: usize) -> Vec<Option<Intent>> {
    let kept = labels.len().saturating_sub(samples);
    let before = std::iter::repeat_n(None, labels.len() - kept);
    before.chain(labels[..kept].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{C, R, labels};

    #[test]
    fn a_delay_is_part_of_the_latency_alone() {
        let labels = labels(&[(R, 300), (C, 300), (R, 300)]);
        let truth = GroundTruth {
            labels: labels.clone(),
            ..GroundTruth::default()
        };
        let emission = Emission::After(51);
        let score = LabelScore::new(&truth, &labels, emission, Rule::default()).unwrap();
        assert_eq!(score.events.gestures[0].latency, Some(51));
        assert_eq!(score.reference.transitions.accuracy(), Some(1.0));
        assert_eq!(delayed(&labels, 51)[..51], [None; 51]);
        assert_eq!(delayed(&labels[..3], 51), [None; 3]);
    }
}
