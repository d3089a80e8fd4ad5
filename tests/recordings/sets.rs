//! Published sets, each against its description.

use recordings::{Recording, runs};
use shared::intent::{Intent, Vocabulary};

use super::{counts, read, seconds_of};

#[test]
fn roshambo_has_its_gestures_and_scissor_unlabelled() {
    let test = "roshambo_has_its_gestures_and_scissor_unlabelled";
    let Some(library) = read(test, "roshambo") else {
        return;
    };
    assert_eq!(counts(library), (8, 24, 1079));
    let labels = [
        Some(Intent::Relax),
        Some(Intent::Open),
        Some(Intent::Close),
        None,
    ];
    let found = labels.map(|label| seconds_of(&library.recordings, label));
    assert!((361..=362).contains(&found[0]), "{found:?}");
    assert!(
        found[1..].iter().all(|s| (238..=240).contains(s)),
        "{found:?}"
    );
    // Five rounds of three gestures; subject05's annotations are UTF-32, the others' bytes.
    for recording in &library.recordings {
        let gestures = runs(&recording.labels);
        let gestures = gestures
            .iter()
            .filter(|run| run.label != Some(Intent::Relax))
            .count();
        assert_eq!(gestures, 15, "{}", recording.path.display());
    }
}

#[test]
fn ss_stm_is_labelled_only_where_its_times_are_known() {
    let test = "ss_stm_is_labelled_only_where_its_times_are_known";
    let Some(library) = read(test, "ss-stm") else {
        return;
    };
    assert_eq!(counts(library), (20, 800, 4000));
    // 100 trials of each motion: 5 s of M1; 1 s and 2 s of rest and 2 s of motion in M2, M3, M8;
    // 1 s of rest in the four others.
    let labels = [
        Intent::Relax,
        Intent::Close,
        Intent::WaveIn,
        Intent::WaveOut,
    ]
    .map(Some);
    let found = labels.map(|label| seconds_of(&library.recordings, label));
    assert_eq!(found, [1800, 200, 200, 200]);
    let three: Vec<_> = library
        .recordings
        .iter()
        .map(|r| r.labels_in(Vocabulary::Three))
        .collect();
    let relax = three
        .iter()
        .flatten()
        .filter(|&&l| l == Some(Intent::Relax))
        .count()
        / 200;
    assert_eq!(
        relax, 1400,
        "rest after a wave is not trusted where waves are unknown"
    );
}

#[test]
fn cote_allard_is_steady_holds_of_seven_classes() {
    let test = "cote_allard_is_steady_holds_of_seven_classes";
    let Some(library) = read(test, "cote-allard") else {
        return;
    };
    assert_eq!(counts(library), (32, 1624, 8080));
    assert!(
        library
            .recordings
            .iter()
            .all(|r| runs(&r.labels).len() == 1)
    );
    let relax = seconds_of(&library.recordings, Some(Intent::Relax));
    assert!((1153..=1155).contains(&relax), "{relax}");
}

#[test]
fn one_subject_myo_has_labels_but_for_its_stream() {
    let test = "one_subject_myo_has_labels_but_for_its_stream";
    let Some(library) = read(test, "one-subject-myo") else {
        return;
    };
    assert_eq!(counts(library), (1, 61, 205));
    let unlabelled: Vec<_> = library
        .recordings
        .iter()
        .filter(|r| !r.has_labels())
        .collect();
    assert_eq!(unlabelled.len(), 1);
    assert!(unlabelled[0].path.ends_with("stream/raw_emg.csv"));
}

/// Counts the stretches of a label.
fn stretches(recording: &Recording, label: Option<Intent>) -> usize {
    let runs = runs(&recording.labels);
    runs.iter().filter(|run| run.label == label).count()
}

#[test]
fn wang_myo_has_twenty_gestures_in_each_file() {
    let test = "wang_myo_has_twenty_gestures_in_each_file";
    let Some(library) = read(test, "wang-myo") else {
        return;
    };
    assert_eq!(counts(library), (17, 170, 24_178));
    let relax = Some(Intent::Relax);
    let mut divided = 0;
    for recording in &library.recordings {
        let path = recording.path.display();
        let gesture = match recording.name.as_str() {
            "1_fist" => Some(Intent::Close),
            "2_pinch" => Some(Intent::Pinch),
            "8_open" => Some(Intent::Open),
            _ => None,
        };
        let other = ["3_two", "4_three", "5_thumb_up", "9_point"];
        let other = other.contains(&recording.name.as_str());
        let found = match gesture {
            Some(_) => stretches(recording, gesture),
            None if other => recording.other_movement.len(),
            None => 20,
        };
        assert_eq!(found, 20, "{path}");
        assert_eq!(other, !recording.other_movement.is_empty(), "{path}");
        // Rest before, between and after; a burst too short for a gesture divides it once more.
        let rests = stretches(recording, relax);
        assert!((19..=25).contains(&rests), "{path}: {rests}");
        divided += usize::from(rests > 21);
        let labels = recording.labels.iter().flatten();
        assert!(
            labels
                .into_iter()
                .all(|&l| Some(l) == gesture || Some(l) == relax)
        );
    }
    assert!(divided < 12, "{divided}");
    let seconds = |label| seconds_of(&library.recordings, Some(label)) as f64;
    let hold = seconds(Intent::Open) / (17.0 * 20.0);
    assert!((2.5..3.5).contains(&hold), "about 3.1 s each: {hold}");
}

#[test]
fn myo_rps_is_labelled_where_the_muscle_is_active() {
    let test = "myo_rps_is_labelled_where_the_muscle_is_active";
    let Some(library) = read(test, "myo-rps") else {
        return;
    };
    assert_eq!(counts(library), (10, 960, 1933));
    let weak: Vec<_> = library
        .recordings
        .iter()
        .filter(|r| !r.has_labels())
        .collect();
    assert!(
        weak.iter()
            .all(|r| r.notes.iter().any(|n| n.contains("hardly rises")))
    );
    // 33 by the description, 14 of them s3's.
    assert!((30..=40).contains(&weak.len()), "{}", weak.len());
    let s3 = weak.iter().filter(|r| r.subject == "myo-rps/s3").count();
    assert!(s3 >= 12, "{s3}");
    let labelled: Vec<_> = library
        .recordings
        .iter()
        .filter(|r| r.has_labels())
        .collect();
    let gesture = |label: &Option<Intent>| label.is_some_and(|l| l != Intent::Relax);
    let from_start = labelled.iter().filter(|r| gesture(&r.labels[0])).count();
    let to_end = labelled
        .iter()
        .filter(|r| r.labels.last().is_some_and(gesture))
        .count();
    assert!(
        (25..=60).contains(&from_start),
        "38 by the description: {from_start}"
    );
    assert!(
        (200..=310).contains(&to_end),
        "254 by the description: {to_end}"
    );
    let active: usize = labelled
        .iter()
        .map(|r| r.labels.iter().filter(|l| gesture(l)).count())
        .sum();
    let mean = active as f64 / labelled.len() as f64 / 200.0;
    assert!((1.0..1.4).contains(&mean), "about 1.2 s each: {mean}");
}

#[test]
fn epn_has_one_gesture_in_each_file() {
    let test = "epn_has_one_gesture_in_each_file";
    let Some(library) = read(test, "epn") else {
        return;
    };
    assert_eq!(counts(library), (1, 300, 1477));
    let mut more = 0;
    for recording in &library.recordings {
        let rest = recording.name.ends_with("noGesture");
        let runs = runs(&recording.labels);
        let relax = runs
            .iter()
            .filter(|r| r.label == Some(Intent::Relax))
            .count();
        let gestures = runs.iter().filter(|r| r.label.is_some()).count() - relax;
        assert_eq!(rest, gestures == 0, "{}", recording.path.display());
        more += usize::from(gestures > 1);
        assert!(!rest || runs.len() == 1);
    }
    assert!(more <= 2, "{more}");
    for intent in [
        Intent::Open,
        Intent::Close,
        Intent::WaveIn,
        Intent::WaveOut,
        Intent::Pinch,
    ] {
        // 50 gestures of about 1.4 s, less in slow edges.
        let seconds = seconds_of(&library.recordings, Some(intent));
        assert!((35..=90).contains(&seconds), "{intent:?} {seconds}");
    }
}

#[test]
fn myoup_trusts_rest_only_far_from_a_pulse() {
    let test = "myoup_trusts_rest_only_far_from_a_pulse";
    let Some(library) = read(test, "myoup") else {
        return;
    };
    assert_eq!(counts(library), (5, 5, 3086));
    for recording in &library.recordings {
        for intent in [Intent::Open, Intent::Close, Intent::WaveIn, Intent::WaveOut] {
            assert_eq!(
                stretches(recording, Some(intent)),
                5,
                "{}",
                recording.subject
            );
        }
        assert_eq!(recording.other_movement.len(), 30, "1 to 4, 7 and 8");
        let runs = runs(&recording.labels);
        let touching = runs
            .windows(2)
            .filter(|p| p[0].label.is_some() && p[1].label.is_some());
        assert_eq!(touching.count(), 0, "{}", recording.subject);
    }
}

#[test]
fn uci_gestures_are_half_and_stretched() {
    let test = "uci_gestures_are_half_and_stretched";
    let Some(library) = read(test, "uci-gestures") else {
        return;
    };
    let (subjects, recordings, seconds) = counts(library);
    assert_eq!((subjects, recordings), (25, 49));
    assert!(seconds.abs_diff(2960) <= 2, "{seconds}");
    for recording in &library.recordings {
        assert!(!recording.data_set.trained_by_default());
        for intent in [
            Intent::Relax,
            Intent::Close,
            Intent::WaveIn,
            Intent::WaveOut,
        ] {
            assert_eq!(
                stretches(recording, Some(intent)),
                2,
                "{}",
                recording.path.display()
            );
        }
        assert_eq!(
            recording.other_movement.len(),
            4,
            "{}",
            recording.path.display()
        );
    }
}

#[test]
fn ciil_is_steady_holds_without_the_person_of_another_set() {
    let test = "ciil_is_steady_holds_without_the_person_of_another_set";
    let Some(library) = read(test, "ciil") else {
        return;
    };
    let (people, recordings, _) = counts(library);
    assert_eq!((people, recordings), (21, 1480));
    let holds = |own: &Recording| runs(&own.labels).len() == 1;
    assert!(library.recordings.iter().all(holds));
    let person = |own: &Recording| own.subject == "ciil/min01";
    assert!(!library.recordings.iter().any(person));
}
