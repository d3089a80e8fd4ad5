//! Timing of labels: cues that the muscle follows late, or the muscle's own activity.
//!
//! The recordings decide it, person by person, not the name of their set:
//!
//! 1. Labels that a reader or the recorder found in the muscle activity are the muscle's.
//! 2. A gesture, or several in a row, has rest around it if the labels say relax for 0.5 s before it and after it, without
//!    a gap. Unless three of four have, the labels are cues without rest.
//! 3. Else the labels are the muscle's if four of five changes between rest and a gesture lie within 60 ms of the muscle's.
//!    People who follow cues differ more: the middle four fifths of one person's changes cover 0.3 s and more.
//! 4. Else they are cues with rest around them, and the muscle shows when each was followed.
//!
//! Labels inside the activity (`myoup`, `uci-gestures`) and steady holds have no such rest.

use std::ops::Range;

use shared::intent::Intent;

use super::lag::lags_of;
use super::runs::{Run, holds, runs};
use crate::recording::{Recording, Timing, by};

/// Minimum length in samples of a rest before and after a gesture: 0.5 s.
const REST: usize = 100;
/// Largest distance of a label's change from the muscle's, in samples, at which the label is the muscle's: 60 ms.
const ON_THE_MUSCLE: f64 = 12.0;
/// Minimum number of changes for labels to be the muscle's.
const FEWEST_CHANGES: usize = 4;

/// Sets the timing of recordings, person by person. Labels that are known to be the muscle's stay so.
pub(crate) fn find(recordings: &mut [Recording]) {
    let cued = recordings.iter_mut();
    let cued = cued.filter(|own| own.timing != Timing::Muscle);
    for own in by(cued, |own| own.subject.clone()).into_values() {
        let timing = of_person(&own);
        for recording in own {
            recording.timing = timing;
        }
    }
}

/// Timing of the labels of one person's recordings.
fn of_person(recordings: &[&mut Recording]) -> Timing {
    let (mut rested, mut gestures) = (0, 0);
    for recording in recordings {
        let own = rests_around(&recording.labels);
        rested += own.iter().filter(|rested| **rested).count();
        gestures += own.len();
    }
    if gestures == 0 || 4 * rested < 3 * gestures {
        return Timing::Cues;
    }
    let lags: Vec<f64> = recordings.iter().flat_map(|own| lags_of(own)).collect();
    let near = lags.iter().filter(|lag| lag.abs() <= ON_THE_MUSCLE).count();
    if lags.len() >= FEWEST_CHANGES && 5 * near >= 4 * lags.len() {
        Timing::Muscle
    } else {
        Timing::RestAroundCues
    }
}

/// Whether rest lies around each gesture, or several in a row.
fn rests_around(labels: &[Option<Intent>]) -> Vec<bool> {
    let runs = runs(labels);
    let is_rest = |run: &Run| run.label == Some(Intent::Relax);
    let is_long = |run: &Run| is_rest(run) && run.samples() >= REST;
    let gestures = holds(&runs, |run| run.label.is_some() && !is_rest(run));
    let rested = |hold: Range<usize>| {
        let before = runs[..hold.start].last();
        before.is_some_and(is_long) && runs.get(hold.end).is_some_and(is_long)
    };
    gestures.into_iter().map(rested).collect()
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::catalogue::DataSet;
    use crate::fixture::{C, O, R};

    /// Runs of labels; the muscle follows each change at once, or after 60 to 130 samples at random.
    fn recording(person: &str, sequence: &[(Option<Intent>, usize)], at_once: bool) -> Recording {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let (mut labels, mut samples, mut loud) = (Vec::new(), Vec::new(), false);
        for &(label, count) in sequence {
            let late = random.random_range(60..130) * usize::from(!at_once);
            for at in 0..count {
                if at == late {
                    loud = label.is_some() && label != R;
                }
                let most = if loud { 40 } else { 3 };
                samples.push([(); 8].map(|()| random.random_range(-most..=most)));
                labels.push(label);
            }
        }
        Recording::new(DataSet::OWN, person, samples, labels)
    }

    fn timing(sequence: &[(Option<Intent>, usize)], at_once: bool) -> Timing {
        let mut recordings = [recording("anna", sequence, at_once)];
        find(&mut recordings);
        recordings[0].timing
    }

    /// Open and close in turn, between rests of `rest` samples.
    fn between_rests(rest: usize) -> Vec<(Option<Intent>, usize)> {
        let turn = [(R, rest), (O, 400), (R, rest), (C, 400)];
        [turn.repeat(4), vec![(R, rest)]].concat()
    }

    #[test]
    fn rest_of_half_a_second_around_each_gesture_shows_when_cues_were_followed() {
        assert_eq!(timing(&between_rests(400), false), Timing::RestAroundCues);
        assert_eq!(timing(&between_rests(100), false), Timing::RestAroundCues);
        assert_eq!(timing(&between_rests(99), false), Timing::Cues);
        let paper = [(R, 400), (O, 400), (C, 400), (O, 400)].repeat(4);
        let to_the_end = [paper, vec![(R, 400)]].concat();
        assert_eq!(timing(&to_the_end, false), Timing::RestAroundCues);
    }

    #[test]
    fn labels_inside_the_activity_and_steady_holds_have_no_rest_around_them() {
        let inside = [(R, 400), (None, 60), (O, 300), (None, 60)].repeat(5);
        assert_eq!(timing(&inside, false), Timing::Cues);
        for hold in [O, R, None] {
            assert_eq!(timing(&[(hold, 2000)], false), Timing::Cues);
        }
        // Three of four gestures are enough, half of them are not.
        let with = |bare: usize| [between_rests(400), [(None, 9), (O, 400)].repeat(bare)].concat();
        assert_eq!(timing(&with(2), false), Timing::RestAroundCues);
        assert_eq!(timing(&with(8), false), Timing::Cues);
    }

    #[test]
    fn labels_that_lie_on_the_muscle_are_the_muscles() {
        assert_eq!(timing(&between_rests(400), true), Timing::Muscle);
    }

    #[test]
    fn each_person_is_judged_by_all_of_their_recordings_and_what_is_known_stays() {
        let rested = recording("anna", &between_rests(400), false);
        let rest_alone = recording("anna", &[(R, 900)], false);
        let hold = recording("ben", &[(C, 900)], false);
        let known = Recording {
            timing: Timing::Muscle,
            ..rested.clone()
        };
        let mut all = [rested, rest_alone, hold, known];
        find(&mut all);
        let rested = Timing::RestAroundCues;
        let expected = [rested, rested, Timing::Cues, Timing::Muscle];
        assert_eq!(all.map(|own| own.timing), expected);
    }
}
