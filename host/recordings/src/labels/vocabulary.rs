//! Labels of six classes in a smaller vocabulary.

use shared::intent::{Intent, Vocabulary};

use super::runs::runs;
use crate::catalogue::DataSet;
use crate::recording::Recording;
use crate::recording::movement::{Movement, MovementKind};

impl Recording {
    /// The labels in a vocabulary: intents outside it become none, never a wrong label.
    ///
    /// Where the end of a set's gestures is unknown, the rest after such an intent becomes none too.
    pub fn labels_in(&self, vocabulary: Vocabulary) -> Vec<Option<Intent>> {
        let mut labels = self.labels.clone();
        let mut may_still_hold = false;
        for run in runs(&self.labels) {
            let outside = run.label.is_some_and(|intent| !vocabulary.contains(intent));
            if outside || (may_still_hold && run.label == Some(Intent::Relax)) {
                labels[run.start..run.end].fill(None);
            }
            may_still_hold = outside && self.data_set.releases_at_unknown_times();
        }
        labels
    }

    /// Whether any sample has a label of a vocabulary.
    pub fn has_labels_in(&self, vocabulary: Vocabulary) -> bool {
        self.labels_in(vocabulary).iter().any(Option::is_some)
    }

    /// Whether models can be evaluated on the recording: it has labels of a vocabulary, or movement that is none of the
    /// six intents.
    pub fn can_be_evaluated(&self, vocabulary: Vocabulary) -> bool {
        !self.other_movement.is_empty() || self.has_labels_in(vocabulary)
    }

    /// Movement that is no intent of a vocabulary, in order and as late as the labels: other movement, and intents
    /// outside the vocabulary.
    pub fn movement_outside(&self, vocabulary: Vocabulary) -> Vec<Movement> {
        let mut movements = self.other_movement.clone();
        movements.extend(runs(&self.labels).into_iter().filter_map(|run| {
            let intent = run.label.filter(|&intent| !vocabulary.contains(intent))?;
            let kind = MovementKind::Intent(intent);
            Some(Movement::new(kind, run.start..run.end))
        }));
        movements.sort_unstable_by_key(|movement| movement.samples.start);
        movements
    }
}

impl DataSet {
    /// Whether rest that follows a gesture may still hold the gesture until its end.
    ///
    /// `ss-stm` has nominal times only and its gestures are released up to 1.5 s late.
    fn releases_at_unknown_times(self) -> bool {
        self == Self::named("ss-stm")
    }
}

/// The smallest vocabulary with all labels.
pub fn smallest<'a>(labels: impl IntoIterator<Item = &'a Option<Intent>>) -> Vocabulary {
    let last = labels.into_iter().flatten().max();
    [Vocabulary::Three, Vocabulary::Five]
        .into_iter()
        .find(|vocabulary| last.is_none_or(|&intent| vocabulary.contains(intent)))
        .unwrap_or(Vocabulary::Six)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{C, R, W};

    fn recording(data_set: DataSet) -> Recording {
        let labels = vec![R, W, R, C, R];
        Recording::new(data_set, "", vec![[0; 8]; labels.len()], labels)
    }

    #[test]
    fn intents_outside_the_vocabulary_become_none() {
        let recording = recording(DataSet::named("myo-readings"));
        assert_eq!(recording.labels_in(Vocabulary::Six), recording.labels);
        let three = recording.labels_in(Vocabulary::Three);
        assert_eq!(three, [R, None, R, C, R]);
    }

    #[test]
    fn movement_outside_is_other_movement_and_other_intents() {
        let mut recording = recording(DataSet::named("myo-readings"));
        recording.labels.extend([None; 3]);
        let wave_in = Movement::new(MovementKind::Intent(Intent::WaveIn), 1..2);
        let point = Movement::new(MovementKind::Point, 6..8);
        recording.other_movement = vec![point.clone()];
        let outside = |vocabulary| recording.movement_outside(vocabulary);
        assert_eq!(outside(Vocabulary::Six), recording.other_movement);
        assert_eq!(outside(Vocabulary::Three), [wave_in, point]);
    }

    #[test]
    fn rest_after_a_gesture_of_unknown_end_becomes_none_too() {
        let three = recording(DataSet::named("ss-stm")).labels_in(Vocabulary::Three);
        assert_eq!(three, [R, None, None, C, R]);
    }

    #[test]
    fn three_classes_do_until_a_label_needs_more() {
        assert_eq!(smallest(&[R, None, C]), Vocabulary::Three);
        assert_eq!(smallest(&[R, W, C]), Vocabulary::Five);
        assert_eq!(smallest(&[Some(Intent::Pinch), W]), Vocabulary::Six);
        assert_eq!(smallest(&[]), Vocabulary::Three);
    }
}
