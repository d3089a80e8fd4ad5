//! Two halves of a person's recordings: of each motion, the first half of its holds is tuned on, the other half judged.

use std::collections::BTreeMap;
use std::ops::Range;

use recordings::labels::motion::{GroundTruth, Motion, motions};
use recordings::{Library, Recording, runs};
use shared::intent::Vocabulary;
use shared::units::SAMPLE_RATE_HZ;

/// Fewest samples of a hold: 1 s.
const SHORTEST: usize = SAMPLE_RATE_HZ as usize;
/// Most samples of rest that are kept on either side of a hold: 1 s.
const REST: usize = SAMPLE_RATE_HZ as usize;

/// Hold of one motion, with the rest around it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hold {
    recording: usize,
    /// Samples of the hold and of the rest around it.
    range: Range<usize>,
    /// Samples of the hold.
    pub(super) samples: usize,
}

/// Holds of a half, in order: gestures of the vocabulary, and kinds of other movement by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Half {
    pub(super) gestures: BTreeMap<&'static str, Vec<Hold>>,
    pub(super) others: BTreeMap<&'static str, Vec<Hold>>,
}

/// Divides the holds of a person's recordings in two.
pub(super) fn halves(recordings: &[&Recording], vocabulary: Vocabulary) -> [Half; 2] {
    let mut all: BTreeMap<(bool, &'static str), Vec<Hold>> = BTreeMap::new();
    for (at, own) in recordings.iter().enumerate() {
        let motions = motions(&own.labels, &own.other_movement);
        let runs = runs(&motions);
        let is_rest_alone = runs.iter().all(|run| run.label == Motion::RELAX);
        for (place, run) in runs.iter().enumerate() {
            let is_gesture = match run.label {
                Motion::RELAX if is_rest_alone => true,
                Motion::RELAX | Motion::Unknown | Motion::Unnamed => continue,
                Motion::Intent(intent) => vocabulary.intents().contains(&intent),
                Motion::Other(_) => false,
            };
            if run.samples() < SHORTEST {
                continue;
            }
            let rest = |place: Option<usize>| {
                let run = place.and_then(|place| runs.get(place));
                run.filter(|run| run.label == Motion::RELAX)
                    .map_or(0, |run| run.samples().min(REST))
            };
            let hold = Hold {
                recording: at,
                range: run.start - rest(place.checked_sub(1))..run.end + rest(Some(place + 1)),
                samples: run.samples(),
            };
            let key = (is_gesture, run.label.name());
            all.entry(key).or_default().push(hold);
        }
    }
    let mut halves = [Half::default(), Half::default()];
    for ((is_gesture, name), holds) in all {
        let (first, second) = holds.split_at(holds.len() / 2);
        for (half, holds) in halves.iter_mut().zip([first, second]) {
            let side = if is_gesture {
                &mut half.gestures
            } else {
                &mut half.others
            };
            side.insert(name, holds.to_vec());
        }
    }
    halves
}

impl Half {
    /// Holds of the gestures, and of other movement those of the kinds that are wanted: of each kind in turn the next one,
    /// until they last `seconds`.
    pub(super) fn holds(&self, seconds: f64, is_wanted: impl Fn(&str) -> bool) -> Vec<Hold> {
        let mut holds: Vec<Hold> = self.gestures.values().flatten().cloned().collect();
        let wanted = || self.others.iter().filter(|(name, _)| is_wanted(name));
        let longest = wanted().map(|(_, holds)| holds.len()).max().unwrap_or(0);
        let in_turn = (0..longest).flat_map(|at| wanted().filter_map(move |(_, own)| own.get(at)));
        let mut samples = 0;
        for hold in in_turn {
            if samples as f64 >= seconds * f64::from(SAMPLE_RATE_HZ) {
                break;
            }
            samples += hold.samples;
            holds.push(hold.clone());
        }
        holds.sort_by_key(|hold| (hold.recording, hold.range.start));
        holds
    }
}

/// Joins holds to one recording, in a library of its own.
pub(super) fn joined(recordings: &[&Recording], holds: &[Hold]) -> Library {
    let mut joined = Recording {
        samples: Vec::new(),
        ..recordings[0].clone()
    };
    let mut all = Vec::new();
    for hold in holds {
        let own = recordings[hold.recording];
        joined.samples.extend(&own.samples[hold.range.clone()]);
        let motions = motions(&own.labels, &own.other_movement);
        all.extend(&motions[hold.range.clone()]);
    }
    let truth: GroundTruth = all.into_iter().collect();
    joined.labels = truth.labels;
    joined.other_movement = truth.other_movement;
    Library {
        recordings: vec![joined],
        ..Library::default()
    }
}

#[cfg(test)]
mod tests {
    use recordings::{DataSet, Movement, MovementKind};
    use shared::intent::Intent;

    use super::*;

    /// Four openings, two fists, two waves and four times pointing, each for 1.5 s after 2 s of rest.
    fn recording() -> Recording {
        let (mut labels, mut other_movement) = (Vec::new(), Vec::new());
        for at in 0..12 {
            labels.extend([Some(Intent::Relax); 400]);
            let intent = match at % 6 {
                0 | 1 => Some(Intent::Open),
                2 => Some(Intent::Close),
                3 => Some(Intent::WaveIn),
                _ => None,
            };
            if intent.is_none() {
                let samples = labels.len()..labels.len() + 300;
                other_movement.push(Movement::new(MovementKind::Point, samples));
            }
            labels.extend([intent; 300]);
        }
        labels.extend([Some(Intent::Relax); 100]);
        let samples = (0..labels.len()).map(|at| [(at % 100) as i8; 8]).collect();
        Recording {
            other_movement,
            ..Recording::new(DataSet::OWN, "own/a".to_owned(), samples, labels)
        }
    }

    #[test]
    fn each_motion_is_halved_and_an_intent_outside_the_vocabulary_is_other_movement() {
        let own = recording();
        let [first, second] = halves(&[&own], Vocabulary::Three);
        for half in [&first, &second] {
            let count = |holds: &BTreeMap<&'static str, Vec<Hold>>| -> Vec<_> {
                holds.iter().map(|(name, own)| (*name, own.len())).collect()
            };
            assert_eq!(count(&half.gestures), [("close", 1), ("open", 2)]);
            assert_eq!(count(&half.others), [("point", 2), ("wave-in", 1)]);
        }
        assert!(first.gestures["open"][1].range.end <= second.gestures["open"][0].range.start);
    }

    #[test]
    fn other_movement_is_taken_from_each_kind_in_turn_until_it_lasts() {
        let own = recording();
        let [first, _] = halves(&[&own], Vocabulary::Three);
        let others = |seconds, is_wanted: fn(&str) -> bool| {
            let holds = first.holds(seconds, is_wanted);
            let truth = &joined(&[&own], &holds).recordings[0];
            let seconds = |motion| {
                let motions = motions(&truth.labels, &truth.other_movement);
                motions.into_iter().filter(|own| *own == motion).count() as f64 / 200.0
            };
            let point = seconds(Motion::Other(MovementKind::Point));
            (point, seconds(Motion::Intent(Intent::WaveIn)))
        };
        assert_eq!(others(0.0, |_| true), (0.0, 0.0));
        assert_eq!(others(1.6, |_| true), (1.5, 1.5));
        assert_eq!(others(60.0, |_| true), (3.0, 1.5));
        assert_eq!(others(60.0, |kind| kind != "point"), (0.0, 1.5));
    }

    #[test]
    fn a_recording_of_rest_alone_is_halved_as_a_gesture_is() {
        let rest = Recording {
            labels: vec![Some(Intent::Relax); 400],
            samples: vec![[0; 8]; 400],
            other_movement: Vec::new(),
            ..recording()
        };
        let own = [&recording(), &rest, &rest];
        let [first, second] = halves(&own, Vocabulary::Three);
        for half in [&first, &second] {
            assert_eq!(half.gestures["relax"].len(), 1);
        }
    }

    #[test]
    fn joined_holds_keep_samples_and_motions_together() {
        let own = recording();
        let [first, _] = halves(&[&own], Vocabulary::Three);
        let joined = joined(&[&own], &first.holds(60.0, |_| true));
        let own_open = own
            .labels
            .iter()
            .position(|label| *label == Some(Intent::Open));
        let recording = &joined.recordings[0];
        // The first hold has one second of rest before it.
        assert_eq!(recording.labels[200], Some(Intent::Open));
        assert_eq!(recording.samples[200], own.samples[own_open.unwrap()]);
        assert_eq!(recording.samples.len(), recording.labels.len());
        assert_eq!(recording.samples.len(), 6 * (300 + 400));
    }
}
