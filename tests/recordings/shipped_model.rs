//! Shipped model on held-out people.

use std::collections::BTreeSet;

use evaluation::metric::event::latency::Latency;
use evaluation::{
    Difference, EnergyDetector, EvaluatedRecording, LookAhead, Measure, Score, System, Truth,
    constant, integer_candidate, score_all,
};
use recordings::labels::compensation::Compensation;
use recordings::split::predefined::is_test;
use recordings::{Library, Recording};
use shared::intent::Vocabulary;
use shared::model::file::Model;
use shared::units::Sample;

use super::read;

/// Returns the recordings with labels shifted by the lag of their data set.
fn evaluated(library: &Library) -> Vec<EvaluatedRecording> {
    let evaluated = |recording: &Recording| {
        let set = recording.data_set;
        let lag = Compensation::Constant(set.label_lag());
        let align = |samples: &mut Vec<Sample>| set.align(samples);
        EvaluatedRecording::new(recording, align, Vocabulary::Three, lag)
    };
    library.recordings.iter().map(evaluated).collect()
}

#[test]
fn the_shipped_model_is_above_the_floors_and_no_gesture_is_seen_before_it_is_made() {
    let Some(library) = read("wang-myo") else {
        return;
    };
    let all = evaluated(library);
    let bytes = std::fs::read(myointent_tests::shipped("three-class")).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let provenance = &model.header.provenance;
    let left_out = |recording: &EvaluatedRecording| {
        let mut names = provenance.subjects_left_out.iter();
        names.any(|name| name == recording.subject)
    };
    let (mut recordings, training): (Vec<_>, Vec<_>) = all.into_iter().partition(left_out);
    // The model was trained on the others. Test people are not scored here.
    recordings.retain(|recording| !is_test(&recording.subject));
    let subjects = recordings.iter().map(|recording| &recording.subject);
    let people = subjects.collect::<BTreeSet<_>>().len();
    assert_eq!(people, 3);
    assert!(!training.is_empty());
    let own = integer_candidate("model", &model, &recordings).unwrap();
    let detector = EnergyDetector::fit(&training).unwrap();
    let candidates = [own, constant(&recordings), detector.candidate(&recordings)];
    let truths = [Truth::LagCompensated];
    let scores = score_all(&candidates, &recordings, Vocabulary::Three, &truths).unwrap();
    let of = |model: System, look_ahead: LookAhead| {
        let mut scores = scores.iter();
        scores
            .find(|score| score.model == model && score.look_ahead == look_ahead)
            .unwrap()
    };
    let balanced = |score: &Score| Measure::BalancedAccuracy.mean(score).unwrap().mean;
    let floor = |system| of(system, LookAhead::None);
    let (constant, energy) = (floor(System::Constant), floor(System::Energy));
    assert!((balanced(constant) - 1.0 / 3.0).abs() < 1e-9);
    let flicker = Measure::Flicker.mean(constant).unwrap().mean;
    assert_eq!((constant.events.recognised, flicker), (0, 0.0));
    assert!(constant.events.gestures > 30 * people);
    let decided = |score: &Score| {
        let [decided, kept] = [Measure::Decided, Measure::RestKept];
        [decided, kept].map(|measure| measure.mean(score).unwrap().mean)
    };
    assert_eq!(decided(constant), [0.0, 1.0]);
    for look_ahead in LookAhead::ALL {
        let score = of("model".into(), look_ahead);
        assert!(balanced(score) > balanced(energy) && balanced(energy) > balanced(constant));
        let difference = Difference::of(Measure::Recognition, score, constant).unwrap();
        assert!(difference.mean.mean > 0.3, "{difference:?}");
        // One decision asks for less than recognition, and for more than one class for everything.
        let recognised = Measure::Recognition.mean(score).unwrap().mean;
        let [own, kept] = decided(score);
        println!("{look_ahead:?}: recognised {recognised}, decided {own}, rest kept {kept}");
        assert!(own > recognised && own > decided(energy)[0] && kept > 0.9);
        // Three people show no difference, however clear their numbers.
        assert_eq!((difference.mean.n, difference.is_shown()), (3, false));
        // The hand moves 50 ms or more before a label of the newest patch, and 0.25 s before one with look-ahead.
        let latency = score.events.latency.unwrap();
        let Latency::Ms(median) = latency.median else {
            panic!("{latency:?}")
        };
        let is_ahead = look_ahead != LookAhead::None;
        let least = if is_ahead { 250.0 } else { 50.0 };
        let is_late = (least..1000.0).contains(&median);
        assert!(is_late, "{look_ahead:?}: {median}");
    }
}
