//! Lag compensation of labels: published labels are cues, which the muscle follows late.

use serde::{Deserialize, Serialize};

use super::cued::follow;
use super::lag;
use super::motion::{GroundTruth, Motion, motions};
use super::runs::runs;
use crate::recording::Recording;
use crate::recording::movement::Movement;

/// Minimum length in samples of an unknown stretch between two rests that counts as a movement: 0.5 s.
const MOVEMENT: usize = 100;

/// Lag compensation of labels.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compensation {
    /// All labels are moved this many samples later.
    Constant(usize),
    /// A gesture's label is moved to where the muscle follows its cue; none where it does not.
    EachCue,
}

impl Compensation {
    /// Labels stay as they are.
    pub const NONE: Self = Self::Constant(0);
}

impl Recording {
    /// The recording with compensated labels and other movement.
    ///
    /// Other movement that the muscle does not show is kept, moved by the set's usual lag: a label that it raises is
    /// wrong too.
    pub fn compensated(&self, compensation: Compensation) -> Self {
        self.clone().with_truth(match compensation {
            Compensation::Constant(samples) => self.later(samples),
            Compensation::EachCue => self.followed(),
        })
    }

    /// Labels and other movement, moved `samples` later.
    fn later(&self, samples: usize) -> GroundTruth {
        let length = self.labels.len();
        let movements = self.other_movement.iter().map(|movement| Movement {
            samples: lag::compensated_range(&movement.samples, samples, length),
            ..movement.clone()
        });
        GroundTruth {
            labels: lag::compensated(&self.labels, samples),
            // Movement that would begin after the end of the recording is dropped.
            other_movement: movements.filter(|own| !own.samples.is_empty()).collect(),
        }
    }

    /// Labels and other movement where the muscle follows its cues.
    fn followed(&self) -> GroundTruth {
        let mut cues = motions(&self.labels, &self.other_movement);
        name_movements(&mut cues);
        // Unknown stretches count as rest for the muscle's level, but stay unknown.
        let known_rest = |cue: &Motion| match cue {
            Motion::Unknown => Motion::RELAX,
            cue => *cue,
        };
        let followed = follow(
            &self.samples,
            &cues.iter().map(known_rest).collect::<Vec<_>>(),
        );
        let mut found = followed.motions;
        for (found, cue) in found.iter_mut().zip(&cues) {
            if *cue == Motion::Unknown && *found == Motion::RELAX {
                *found = Motion::Unknown;
            }
        }
        let usual = self.data_set.label_lag();
        for movement in &self.other_movement {
            let of_movement =
                |hold: &&super::cued::Hold| hold.samples.contains(&movement.samples.start);
            let hold = followed.holds.iter().find(of_movement);
            if hold.is_none_or(|hold| hold.active.is_none()) {
                let late = lag::compensated_range(&movement.samples, usual, found.len());
                found[late].fill(Motion::Other(movement.kind));
            }
        }
        found.into_iter().collect()
    }
}

/// Marks unknown stretches between two rests as movement without a name, which the muscle then places.
fn name_movements(cues: &mut [Motion]) {
    for three in runs(cues).windows(3) {
        let [before, unknown, after] = three else {
            continue;
        };
        let between_rests = [before.label, after.label] == [Motion::RELAX; 2];
        if between_rests && unknown.label == Motion::Unknown && unknown.samples() >= MOVEMENT {
            cues[unknown.start..unknown.end].fill(Motion::Unnamed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::DataSet;
    use crate::fixture::{C, O, R, labels, muscle};
    use crate::recording::movement::MovementKind;

    /// Cues of rest, open, rest, scissors, rest, close, rest; the muscle is loud in these ranges.
    fn recording(loud: &[std::ops::Range<usize>]) -> Recording {
        let cues = [O, R, None, R, C, R].map(|label| (label, 400));
        let labels = [vec![R; 600], labels(&cues)].concat();
        let samples = muscle(labels.len(), loud);
        let mut recording =
            Recording::new(DataSet::named("roshambo"), "roshambo/01", samples, labels);
        recording.other_movement = vec![Movement::new(MovementKind::TwoFingers, 1400..1800)];
        recording
    }

    fn near(found: usize, expected: usize) -> bool {
        found.abs_diff(expected) <= 10
    }

    #[test]
    fn every_cue_has_a_lag_of_its_own() {
        let published = recording(&[650..1080, 1380..1870, 2290..2700]);
        let found = published.compensated(Compensation::EachCue);
        let labels = runs(&found.labels);
        let names: Vec<_> = labels.iter().map(|run| run.label).collect();
        assert_eq!(names, [R, O, R, None, R, C, R]);
        let starts = labels.iter().skip(1).map(|run| run.start);
        for (start, expected) in starts.zip([650, 1080, 1380, 1870, 2290, 2700]) {
            assert!(near(start, expected), "{start} instead of {expected}");
        }
        let [scissors] = &found.other_movement[..] else {
            panic!("{:?}", found.other_movement);
        };
        assert!(near(scissors.samples.start, 1380) && near(scissors.samples.end, 1870));
        assert_eq!(found.samples, published.samples);
    }

    #[test]
    fn a_gesture_that_is_not_made_is_unknown_and_other_movement_that_is_not_seen_is_kept() {
        let found =
            recording(std::slice::from_ref(&(2290..2700))).compensated(Compensation::EachCue);
        assert!(!found.labels.contains(&O) && found.labels[2500] == C);
        assert!(found.labels[600..1000].iter().all(Option::is_none));
        let late = DataSet::named("roshambo").label_lag();
        let scissors = Movement::new(MovementKind::TwoFingers, 1400 + late..1800 + late);
        assert_eq!(found.other_movement, [scissors]);
    }

    #[test]
    fn what_is_unknown_stays_unknown_while_the_muscle_rests() {
        let mut published = recording(std::slice::from_ref(&(650..1080)));
        published.labels[1000..1400].fill(None);
        let found = published.compensated(Compensation::EachCue).labels;
        assert_eq!(found[1040], O);
        assert!(found[1100..1390].iter().all(Option::is_none));
    }

    #[test]
    fn a_movement_without_a_name_has_the_labels_around_it_of_one_with_a_name() {
        let all = [650..1080, 1380..1870, 2290..2700];
        for loud in [&all[..], &all[..1], &all[1..2], &[900..1000, 1500..2400]] {
            let named = recording(loud);
            let mut unnamed = named.clone();
            unnamed.other_movement.clear();
            let labels = |own: &Recording| own.compensated(Compensation::EachCue).labels;
            assert_eq!(labels(&unnamed), labels(&named), "{loud:?}");
        }
    }

    #[test]
    fn a_short_gap_between_two_rests_is_no_movement() {
        let mut published = recording(&[650..1080, 1380..1870, 2290..2700]);
        published.labels[250..340].fill(None);
        let found = published.compensated(Compensation::EachCue).labels;
        assert!(found[250..340].iter().all(Option::is_none));
        assert!(found[340..600].iter().all(|label| *label == R));
    }

    #[test]
    fn a_constant_moves_everything() {
        let published = recording(&[]);
        let found = published.compensated(Compensation::Constant(50));
        assert_eq!((found.labels[649], found.labels[650]), (R, O));
        assert_eq!(found.other_movement[0].samples, 1450..1850);
        let nearly_all = published.compensated(Compensation::Constant(2950));
        assert!(nearly_all.other_movement.is_empty());
        assert_eq!(published.compensated(Compensation::NONE), published);
    }
}
