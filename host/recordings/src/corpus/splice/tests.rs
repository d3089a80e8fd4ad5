//! Spliced recordings of a few hand-written ones.

use std::collections::BTreeSet;

use shared::intent::Intent;

use super::holds::HOLD;
use super::{SpliceOptions, splice};
use crate::catalogue::DataSet;
use crate::fixture::{C, O, R, labels};
use crate::labels::runs::{Run, runs};
use crate::recording::Recording;
use crate::recording::movement::{Movement, MovementKind, mask};

/// Every sample carries its label's number, so that a cut at the wrong place shows.
fn recording(subject: &str, sequence: &[(Option<Intent>, usize)]) -> Recording {
    let labels = labels(sequence);
    let samples = labels.iter().map(|&label| [mark(label); 8]).collect();
    Recording::new(DataSet::SYNTHETIC, subject, samples, labels)
}

fn mark(label: Option<Intent>) -> i8 {
    label.map_or(-1, |intent| intent.class() as i8)
}

/// Recordings of so many samples, spliced from these.
fn spliced(recordings: &[Recording], samples: usize, other: bool) -> Vec<Recording> {
    let recordings: Vec<&Recording> = recordings.iter().collect();
    let options = SpliceOptions {
        samples,
        count: 2,
        other,
        seed: 42,
    };
    splice(&recordings, &options)
}

/// Rock, rest, paper, rest, scissor, rest.
fn roshambo() -> Recording {
    let round = [C, O, None].map(|label| [(label, 400), (R, 200)]);
    recording("a", &round.concat().repeat(3))
}

#[test]
fn steady_recordings_come_in_between_transitions() {
    let cued = recording("a", &[(R, 400), (C, 400), (R, 400)]);
    let mut steady = recording("a", &[(R, 3000)]);
    steady.samples.fill([77; 8]);
    let spliced = &spliced(&[cued, steady], 20_000, false)[0];
    let rows = spliced.samples.iter().zip(&spliced.labels);
    let steady: Vec<_> = rows.filter(|(sample, _)| **sample == [77; 8]).collect();
    assert!(steady.len() > 1000 && steady.iter().all(|(_, label)| **label == R));
}

#[test]
fn samples_keep_their_labels_and_the_length_is_exact() {
    let all = spliced(&[roshambo()], 4321, false);
    assert_eq!(all.len(), 2);
    for own in &all {
        assert_eq!((own.samples.len(), own.labels.len()), (4321, 4321));
        let mut rows = own.samples.iter().zip(&own.labels);
        assert!(rows.all(|(sample, &label)| sample[0] == mark(label)));
    }
    assert_ne!(all[0].labels, all[1].labels);
    assert_eq!(all, spliced(&[roshambo()], 4321, false));
}

#[test]
fn the_order_is_broken_and_only_recorded_transitions_occur() {
    let spliced = spliced(&[roshambo()], 200_000, false);
    let found = runs(&spliced[0].labels);
    let gestures: Vec<_> = found.iter().map(|r| r.label).filter(|&l| l != R).collect();
    let pairs: BTreeSet<_> = gestures.windows(2).map(|p| (p[0], p[1])).collect();
    assert_eq!(pairs.len(), 9, "every gesture follows every gesture");
    assert!(found.windows(2).all(|p| p[0].label == R || p[1].label == R));
    let whole = &found[1..found.len() - 1];
    let lengths: Vec<_> = whole.iter().map(Run::samples).collect();
    assert!(lengths.iter().all(|length| (100..=600).contains(length)));
    assert!(lengths.iter().min() < Some(&120) && lengths.iter().max() > Some(&550));
}

#[test]
fn motions_without_a_known_end_do_not_stop_the_walk() {
    let close = recording("a", &[(R, 200), (C, 400), (R, 400)]);
    let unknown = recording("a", &[(R, 200), (None, 800)]);
    let spliced = spliced(&[close, unknown], 4321, false);
    assert_eq!(spliced.len(), 2);
    assert!(spliced[0].labels.iter().all(Option::is_some));
}

#[test]
fn steady_holds_are_joined_with_and_without_rest_between() {
    let holds = [R, O, C].map(|label| recording("a", &[(label, 1000)]));
    let spliced = spliced(&holds, 100_000, false);
    let found = runs(&spliced[0].labels);
    let pairs: BTreeSet<_> = found.windows(2).map(|p| (p[0].label, p[1].label)).collect();
    assert_eq!(pairs.len(), 6, "all three follow one another");
    let whole = &found[1..found.len() - 1];
    assert!(whole.iter().all(|run| HOLD.contains(&run.samples())));
    assert_eq!(spliced[0].samples.len(), 100_000);
}

#[test]
fn subjects_are_not_mixed_and_unlabelled_ones_left_out() {
    let people = [
        roshambo(),
        recording("b", &[(None, 5000)]),
        recording("c", &[(R, 900)]),
    ];
    let spliced = spliced(&people, 4321, false);
    assert!(spliced.iter().all(|r| r.subject == "a"));
}

#[test]
fn movement_outside_the_vocabulary_is_spliced_as_a_gesture_and_marked() {
    let mut cued = recording("a", &[(R, 300), (C, 300), (R, 300), (None, 300), (R, 300)]);
    cued.other_movement = vec![Movement::new(MovementKind::Point, 900..1200)];
    let mut steady = recording("a", &[(None, 1000)]);
    steady.samples.fill([55; 8]);
    steady.other_movement = vec![Movement::new(MovementKind::Point, 0..1000)];
    let both = [cued, steady];
    let marked = spliced(&both, 40_000, true).swap_remove(0);
    let others = mask(&marked.other_movement, marked.labels.len());
    let found = |mark: i8| -> BTreeSet<_> {
        let samples = marked.samples.iter().zip(&marked.labels).zip(&others);
        let marked = samples.filter(|((sample, _), _)| sample[0] == mark);
        marked.map(|((_, &label), &other)| (label, other)).collect()
    };
    // The movement is there, in transitions and in holds, always marked; the gesture keeps its label.
    assert_eq!(found(mark(None)), BTreeSet::from([(None, true)]));
    assert_eq!(found(55), BTreeSet::from([(None, true)]));
    assert_eq!(found(mark(C)), BTreeSet::from([(C, false)]));
    let unknown = &spliced(&both, 40_000, false)[0];
    assert!(unknown.labels.contains(&None) && unknown.other_movement.is_empty());
    assert!(unknown.samples.iter().all(|sample| sample[0] != 55));
}
