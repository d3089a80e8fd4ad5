//! Lag of the labels behind the muscle.

use recordings::labels::lag;
use recordings::split::predefined;
use recordings::{Recording, Timing};

use super::read;

#[test]
fn the_lag_estimated_on_training_people_is_the_nominal_one() {
    // Medians of onset and release in ms over all people, from the recordings' description, by the same rule.
    for (set, onset, release) in [
        ("roshambo", 285.0, 325.0),
        ("ss-stm", 620.0, 950.0),
        ("myo-readings", 230.0, 335.0),
    ] {
        let Some(library) = read(set) else {
            continue;
        };
        let everybody: Vec<_> = library.recordings.iter().collect();
        let found = lag::estimate(&everybody).expect("transitions");
        // In ss-stm only three of the seven motions have a label, so its release differs.
        let tolerance = if set == "ss-stm" { 200.0 } else { 20.0 };
        for off in [found.onset_ms - onset, found.release_ms - release] {
            assert!(off.abs() <= tolerance, "{set}: {found:?}");
        }
        let mut training = everybody;
        training.retain(|own| predefined::is_training(&own.subject));
        let found = lag::estimate(&training).expect("transitions");
        assert_eq!(found.lag_samples, training[0].data_set.label_lag(), "{set}");
    }
}

#[test]
fn labels_from_activity_are_muscle_onsets_without_a_lag() {
    for set in ["wang-myo", "myo-rps", "epn"] {
        let Some(library) = read(set) else {
            continue;
        };
        let recordings: Vec<_> = library.recordings.iter().collect();
        assert_eq!(recordings[0].data_set.label_lag(), 0);
        assert_eq!(lag::estimate(&recordings), None, "nothing moves them");
        // Labels are used as cues: the rule that measures cues finds the muscle where the labels are.
        let cued = |recording: &&Recording| Recording {
            timing: Timing::Cues,
            ..(*recording).clone()
        };
        let cues: Vec<Recording> = recordings.iter().map(cued).collect();
        let found = lag::estimate(&cues.iter().collect::<Vec<_>>()).expect("transitions");
        for ms in [found.onset_ms, found.release_ms] {
            assert!(ms.abs() <= 50.0, "{set}: {found:?}");
        }
    }
}
