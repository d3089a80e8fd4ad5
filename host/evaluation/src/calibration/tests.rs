use std::ops::Range;
use std::path::Path;

use recordings::synthetic::{SynthOptions, generate};
use recordings::{Library, Movement, MovementKind};
use shared::intent::{Intent, Vocabulary};

use super::*;
use crate::fixture::{self, C, O, R};
use crate::model_evaluation::{Lesson, NamedModel, Selection, evaluate_models};
use crate::{ALL, Score, System};

fn shipped() -> Vec<u8> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/three-class.intent");
    std::fs::read(file).unwrap()
}

fn library(subjects: usize) -> Library {
    Library {
        recordings: generate(&SynthOptions {
            subjects,
            recordings: 2,
            seconds: 60,
            ..SynthOptions::default()
        }),
        in_common_frame: true,
        ..Library::default()
    }
}

/// A recording with these labels, each for its number of half seconds, and other movements of these kinds.
fn recording(
    labels: &[(Option<Intent>, usize)],
    others: &[(MovementKind, Range<usize>)],
) -> EvaluatedRecording {
    let samples = labels.iter().map(|&(label, halves)| (label, 100 * halves));
    let others = others.iter().cloned();
    EvaluatedRecording {
        lag_compensated: fixture::labels(&samples.collect::<Vec<_>>()),
        other_movement: others
            .map(|(kind, samples)| Movement::new(kind, samples))
            .collect(),
        ..EvaluatedRecording::made_up("synthetic/a", &[])
    }
}

#[test]
fn a_round_is_a_hold_of_each_gesture_and_two_rests() {
    let first = [(R, 8), (O, 4), (R, 1), (C, 4), (None, 2), (O, 4)];
    let second = [(R, 2), (C, 2), (R, 2), (C, 2)];
    let [first, second] = [&first[..], &second].map(|labels| recording(labels, &[]));
    let own = [&first, &second];
    assert_eq!(rounds_of(&own, Vocabulary::Three), 2);
    assert_eq!(rounds_of(&own[1..], Vocabulary::Three), 0);
    let found = parts(&own, Vocabulary::Three, 2);
    let of = |intent| {
        let own = found.iter();
        let own = own.filter(move |part| part.shown == Shown::Intent(intent));
        let own = own.map(|part| (part.recording, part.samples.clone(), part.round));
        own.collect::<Vec<_>>()
    };
    let rests = [
        (0, 0..600, 0),
        (0, 1200..1300, 0),
        (1, 0..200, 1),
        (1, 400..600, 1),
    ];
    assert_eq!(of(Intent::Relax), rests);
    assert_eq!(of(Intent::Open), [(0, 800..1200, 0), (0, 1900..2300, 1)]);
    assert_eq!(of(Intent::Close), [(0, 1300..1700, 0), (1, 200..400, 1)]);
}

#[test]
fn other_movement_is_shown_kind_by_kind_for_a_second_and_half_of_it_is_left() {
    use MovementKind::{Point, ThumbUp};
    let typing = MovementKind::Daily(recordings::DailyKind::Typing);
    let others = [
        (Point, 0..400),
        (Point, 500..560),
        (Point, 600..1000),
        (ThumbUp, 1200..1350),
        (typing, 1400..3000),
        (ThumbUp, 3100..3300),
    ];
    let found = parts(&[&recording(&[(None, 40)], &others)], Vocabulary::Three, 4);
    let found = found.into_iter().map(|part| (part.shown, part.samples));
    assert!(found.eq([(Shown::Other, 0..200), (Shown::Other, 1200..1350)]));
}

#[test]
fn a_person_gains_and_their_file_has_another_head() {
    let (file, library) = (shipped(), library(1));
    let done = calibrate_file(&file, &library, None, false).unwrap();
    let [old, new] = done.recalls;
    assert!(new > old, "{old} {new}");
    let written = done.file.unwrap();
    let written = Model::parse(&written).unwrap();
    assert_ne!(Head::of(&written), Head::of(&Model::parse(&file).unwrap()));
    let seen = &written.header.provenance.subjects_seen;
    assert!(seen.iter().any(|own| own == done.subject));
}

#[test]
fn a_turned_armband_gains_as_much_and_the_file_is_for_it() {
    let file = shipped();
    let recalls = |file: &[u8], library: &Library| {
        let done = calibrate_file(file, library, None, false).unwrap();
        (done.recalls, done.file)
    };
    let ([_, gained], _) = recalls(&file, &library(1));
    for placed in [Alignment::new(3, false), Alignment::new(6, true)] {
        let mut turned = library(1);
        for own in &mut turned.recordings {
            let worn = own
                .samples
                .iter()
                .map(|sample| placed.inverse().apply(*sample));
            own.samples = worn.collect();
        }
        let ([_, found], written) = recalls(&file, &turned);
        let ([kept, _], _) = recalls(&written.unwrap(), &turned);
        assert!(found + 0.03 > gained, "{found} {gained}");
        assert!(kept + 0.03 > gained, "{kept} {gained}");
    }
}

#[test]
fn other_movement_is_shown_if_it_is_wanted_and_labelled() {
    let (file, mut library) = (shipped(), library(1));
    let calibrated = |library: &Library, others| {
        let done = calibrate_file(&file, library, None, others).unwrap();
        (done.others, done.recalls)
    };
    let without = calibrated(&library, false);
    assert_eq!(calibrated(&library, true), without);
    // The wearer points three times in the last three seconds.
    let own = library.recordings.last_mut().unwrap();
    let end = own.labels.len();
    own.labels[end - 600..].fill(None);
    let seconds = (end - 600..end).step_by(200);
    let point = seconds.map(|start| Movement::new(MovementKind::Point, start..start + 150));
    own.other_movement = point.collect();
    let [left_out, shown] = [false, true].map(|others| calibrated(&library, others));
    assert!(!left_out.0 && shown.0);
    assert_ne!(left_out.1, shown.1);
}

#[test]
fn a_head_that_is_worse_in_the_later_rounds_is_not_used() {
    let (file, mut library) = (shipped(), library(1));
    // In the first recording, which teaches, the gestures have each other's names.
    let first = library.recordings.first_mut().unwrap();
    for label in &mut first.labels {
        *label = label.map(|own| match own {
            Intent::Open => Intent::Close,
            Intent::Close => Intent::Open,
            other => other,
        });
    }
    let done = calibrate_file(&file, &library, None, false).unwrap();
    let [old, new] = done.recalls;
    assert!(new < old && done.file.is_none(), "{old} {new}");
}

#[test]
fn it_must_be_clear_whose_recordings_are_meant() {
    let (file, library) = (shipped(), library(2));
    let found = |name| calibrate_file(&file, &library, name, false).map(|own| own.subject);
    let first = library.subjects()[0].clone();
    let (_, short) = first.split_once('/').unwrap();
    assert_eq!(found(Some(&first)).unwrap(), first);
    assert_eq!(found(Some(short)).unwrap(), first);
    for name in [None, Some("nobody")] {
        let refused = found(name);
        assert!(
            matches!(refused, Err(EvaluationError::Whose(_))),
            "{name:?}"
        );
    }
}

#[test]
fn the_same_remainder_is_judged_for_any_number_of_rounds() {
    let library = library(2);
    let models = [NamedModel::new("m", shipped())];
    let scores = |rounds| {
        let selection = Selection {
            calibrate: Some(Lesson {
                rounds,
                others: false,
                align: false,
            }),
            ..Selection::default()
        };
        evaluate_models(&models, &library, &selection)
            .unwrap()
            .results
    };
    let of = |scores: &[Score], model: &System| {
        let is_own = |own: &&Score| own.model == *model && own.data_set != ALL;
        scores.iter().filter(is_own).cloned().collect::<Vec<_>>()
    };
    let [none, one, two] = [0, 1, 2].map(scores);
    let [own, calibrated] = ["m", "m, calibrated"].map(System::from);
    assert!(of(&none.scores, &calibrated).is_empty());
    for results in [&one, &two] {
        assert_eq!(of(&results.scores, &own), of(&none.scores, &own));
        let after = of(&results.scores, &calibrated);
        let people = |scores: &[Score]| scores[0].emission.subjects.len();
        assert_eq!(people(&after), people(&of(&none.scores, &own)));
        assert_ne!(after, of(&none.scores, &own));
    }
    for (results, is_judged) in [(one, false), (two, true)] {
        let mut calibrations = results.calibrations.iter();
        assert!(calibrations.all(|own| own.calibration.judged.is_some() == is_judged));
    }
}
