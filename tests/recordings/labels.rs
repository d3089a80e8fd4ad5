//! Labels of several sets, and their lag behind the muscle.

use recordings::labels::lag::{self, LabelLag};
use recordings::labels::set_lag::Lag;
use recordings::split::predefined;
use recordings::{Recording, Timing};

use super::read;

#[test]
fn the_lag_estimated_on_training_people_is_the_nominal_one() {
    let test = "the_lag_estimated_on_training_people_is_the_nominal_one";
    // Medians of onset and release in ms over all people, from the recordings' description, by the same rule.
    for (set, onset, release) in [
        ("roshambo", 285.0, 325.0),
        ("ss-stm", 620.0, 950.0),
        ("myo-readings", 230.0, 335.0),
    ] {
        let Some(library) = read(test, set) else {
            continue;
        };
        let everybody: Vec<_> = library.recordings.iter().collect();
        let found = lag::estimate(&everybody).expect("transitions");
        // In ss-stm only three of the seven motions have a label, so its release differs.
        let tolerance = if set == "ss-stm" { 200.0 } else { 20.0 };
        assert!(
            (found.onset_ms - onset).abs() <= tolerance,
            "{set}: {found:?}"
        );
        assert!(
            (found.release_ms - release).abs() <= tolerance,
            "{set}: {found:?}"
        );
        let training = everybody
            .iter()
            .filter(|own| predefined::is_training(&own.subject));
        let training: Vec<&Recording> = training.copied().collect();
        let found = lag::estimate(&training).expect("transitions");
        assert_eq!(found.lag_samples, training[0].data_set.label_lag(), "{set}");
    }
}

#[test]
fn the_recordings_decide_how_their_labels_are_compensated() {
    let test = "the_recordings_decide_how_their_labels_are_compensated";
    for (set, expected) in [
        ("roshambo", "each cue's own lag"),
        ("ss-stm", "each cue's own lag"),
        ("myo-readings", "each cue's own lag"),
        ("cote-allard", "as recorded"),
        ("one-subject-myo", "as recorded"),
        ("myoup", "as recorded"),
        ("uci-gestures", "as recorded"),
        ("wang-myo", "as recorded, where the muscle acts"),
        ("myo-rps", "as recorded, where the muscle acts"),
        ("epn", "as recorded, where the muscle acts"),
    ] {
        let Some(library) = read(test, set) else {
            continue;
        };
        let all: Vec<&Recording> = library.recordings.iter().collect();
        let how = LabelLag::default();
        let lag = Lag::of(all[0].data_set, &all, how, &predefined::is_training);
        assert!(lag.to_string().starts_with(expected), "{set}: {lag}");
        let ways = lag.recordings;
        let several = [ways.each_cue, ways.constant, ways.muscle];
        assert_eq!(
            several.iter().filter(|count| **count > 0).count(),
            1,
            "{set}: {lag}"
        );
    }
}

#[test]
fn labels_from_activity_are_muscle_onsets_without_a_lag() {
    let test = "labels_from_activity_are_muscle_onsets_without_a_lag";
    for set in ["wang-myo", "myo-rps", "epn"] {
        let Some(library) = read(test, set) else {
            continue;
        };
        let recordings: Vec<_> = library.recordings.iter().collect();
        assert_eq!(recordings[0].data_set.label_lag(), 0);
        assert_eq!(lag::estimate(&recordings), None, "nothing moves them");
        // Labels are used as cues: the rule that measures cues finds the muscle where the labels are.
        let cues: Vec<_> = recordings
            .iter()
            .map(|&recording| Recording {
                timing: Timing::Cues,
                ..recording.clone()
            })
            .collect();
        let found = lag::estimate(&cues.iter().collect::<Vec<_>>()).expect("transitions");
        for ms in [found.onset_ms, found.release_ms] {
            assert!(ms.abs() <= 50.0, "{set}: {found:?}");
        }
    }
}

#[test]
fn other_movement_has_no_label() {
    let test = "other_movement_has_no_label";
    for set in [
        "roshambo",
        "ss-stm",
        "cote-allard",
        "wang-myo",
        "myoup",
        "uci-gestures",
    ] {
        let Some(library) = read(test, set) else {
            continue;
        };
        let mut seconds = 0.0;
        for recording in &library.recordings {
            let mut end = 0;
            for range in &recording.other_movement {
                let range = &range.samples;
                assert!(range.start >= end && range.start < range.end, "{set}");
                assert!(
                    recording.labels[range.clone()].iter().all(Option::is_none),
                    "{set}"
                );
                end = range.end;
                seconds += range.len() as f64 / 200.0;
            }
            assert!(end <= recording.samples.len());
        }
        assert!(seconds > 200.0, "{set}: {seconds}");
    }
}
