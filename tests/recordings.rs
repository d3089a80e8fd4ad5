//! The published recordings: counts, labels, lag and splices are as their description states. The
//! recordings themselves are outside the repository.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::OnceLock;

use myointent::dataset::labels::lag;
use myointent::dataset::splice::{SpliceOptions, splice};
use myointent::dataset::{Fault, Library, LoadError, LoadOptions, Place, Recording, load, runs};
use myointent::evaluation::metric::event::latency::Latency;
use myointent::evaluation::{
    ALL, CONSTANT, Candidate, Difference, ENERGY, EnergyDetector, LookAhead, Measure, Score, Trial,
    Truth, constant, score_all,
};
use myointent::inference::device::outputs;
use myointent::inference::integer_logits;
use myointent_tests::{data, skip};
use shared::intent::{Intent, Vocabulary};
use shared::model::file::Model;
use shared::stream::preprocess::clean;
use shared::units::{CleanSample, PATCH, WINDOW};

/// The folder of one set; without it, prints the skip of the test.
fn folder(test: &str, set: &str) -> Option<PathBuf> {
    let folder = data(test)?.join(set);
    if folder.is_dir() {
        return Some(folder);
    }
    let missing = format!("no folder {}: see docs/recordings.md", folder.display());
    skip(test, &missing);
    None
}

fn read(test: &str, set: &str) -> Option<Library> {
    let folder = folder(test, set)?;
    Some(load(&folder, &LoadOptions::default()).expect("the published set is readable"))
}

/// `myo-readings` is large; its tests share one library.
fn myo_readings(test: &str) -> Option<&'static Library> {
    static LIBRARY: OnceLock<Option<Library>> = OnceLock::new();
    folder(test, "myo-readings")?;
    LIBRARY.get_or_init(|| read(test, "myo-readings")).as_ref()
}

fn seconds(recordings: &[Recording]) -> usize {
    recordings
        .iter()
        .map(Recording::seconds)
        .sum::<f64>()
        .round() as usize
}

fn seconds_of(recordings: &[Recording], label: Option<Intent>) -> usize {
    let count = |r: &Recording| r.labels.iter().filter(|&&l| l == label).count();
    (recordings.iter().map(count).sum::<usize>() as f64 / 200.0).round() as usize
}

fn counts(library: &Library) -> (usize, usize, usize) {
    (
        library.subjects().len(),
        library.recordings.len(),
        seconds(&library.recordings),
    )
}

#[test]
fn roshambo_has_its_gestures_and_scissor_unlabelled() {
    let test = "roshambo_has_its_gestures_and_scissor_unlabelled";
    let Some(library) = read(test, "roshambo") else {
        return;
    };
    assert_eq!(counts(&library), (8, 24, 1079));
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
    assert_eq!(counts(&library), (20, 800, 4000));
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
    assert_eq!(counts(&library), (32, 1624, 8080));
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
fn myo_readings_leaves_out_its_four_broken_files_and_says_where() {
    let test = "myo_readings_leaves_out_its_four_broken_files_and_says_where";
    let Some(library) = myo_readings(test) else {
        return;
    };
    // Files of a motion outside the six classes are not read, one with the labels of another motion is.
    let six_classes = |r: &&Recording| !r.name.ends_with("/3");
    assert_eq!(
        (
            library.subjects().len(),
            library.recordings.iter().filter(six_classes).count()
        ),
        (32, 388)
    );
    let found: Vec<_> = library
        .skipped
        .iter()
        .map(|error| match error {
            LoadError::Damaged {
                place: Place::Line(line),
                fault,
                as_published: true,
                ..
            } => {
                assert!(matches!(fault, Fault::Fields { .. } | Fault::Number { .. }));
                *line
            }
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(found, [12322, 1032, 1996, 1347]);
    let Some(folder) = folder(test, "myo-readings") else {
        return;
    };
    let strict = LoadOptions {
        strict: true,
        ..LoadOptions::default()
    };
    assert!(load(&folder, &strict).is_err());
}

#[test]
fn myo_readings_drops_doubled_rows_and_labels_that_drift() {
    let test = "myo_readings_drops_doubled_rows_and_labels_that_drift";
    let Some(library) = myo_readings(test) else {
        return;
    };
    let polled: BTreeSet<_> = library
        .recordings
        .iter()
        .filter(|r| r.notes.iter().any(|note| note.contains("250 Hz")))
        .map(|r| r.subject.as_str())
        .collect();
    assert_eq!(polled, BTreeSet::from(["myo-readings/69069"]));
    for recording in &library.recordings {
        let drifts = ["32185", "35622", "46666", "60186"];
        let drifts = drifts.iter().any(|id| recording.subject.ends_with(id));
        let rest = recording.name.ends_with("/0");
        assert_eq!(
            recording.has_labels(),
            !drifts || rest,
            "{}",
            recording.path.display()
        );
    }
}

#[test]
fn one_subject_myo_takes_its_classes_from_the_metadata() {
    let test = "one_subject_myo_takes_its_classes_from_the_metadata";
    let Some(library) = read(test, "one-subject-myo") else {
        return;
    };
    assert_eq!(counts(&library), (1, 61, 205));
    let unlabelled: Vec<_> = library
        .recordings
        .iter()
        .filter(|r| !r.has_labels())
        .collect();
    assert_eq!(unlabelled.len(), 1);
    assert!(unlabelled[0].path.ends_with("stream/raw_emg.csv"));
}

#[test]
fn the_estimated_lag_is_the_nominal_one() {
    let test = "the_estimated_lag_is_the_nominal_one";
    // Medians of onset and release in ms, from the recordings' description, by the same rule.
    for (set, onset, release) in [
        ("roshambo", 285.0, 325.0),
        ("ss-stm", 620.0, 950.0),
        ("myo-readings", 230.0, 335.0),
    ] {
        let Some(library) = read(test, set) else {
            continue;
        };
        let recordings: Vec<_> = library.recordings.iter().collect();
        let found = lag::estimate(&recordings).expect("transitions");
        assert_eq!(
            found.lag_samples,
            recordings[0].data_set.label_lag(),
            "{set}"
        );
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
    }
}

#[test]
fn spliced_recordings_have_every_class_and_no_fixed_order() {
    let test = "spliced_recordings_have_every_class_and_no_fixed_order";
    for (set, direct) in [
        ("roshambo", false),
        ("ss-stm", false),
        ("cote-allard", true),
    ] {
        let Some(library) = read(test, set) else {
            continue;
        };
        let sources: Vec<_> = library.recordings.iter().collect();
        let lag_samples = sources[0].data_set.label_lag();
        let options = SpliceOptions {
            samples: 24_000,
            count: 1,
            lag_samples,
            seed: 42,
        };
        let spliced = splice(&sources, &options);
        assert_eq!(spliced.len(), library.subjects().len(), "{set}");
        for recording in &spliced {
            assert_eq!(
                (recording.samples.len(), recording.labels.len()),
                (24_000, 24_000)
            );
            let found = runs(&recording.labels);
            let gestures: Vec<_> = found
                .iter()
                .map(|r| r.label)
                .filter(|&l| l != Some(Intent::Relax))
                .collect();
            let orders: BTreeSet<_> = gestures.windows(2).map(|p| (p[0], p[1])).collect();
            // As recorded, roshambo has three: rock paper, paper scissor, scissor rock.
            assert!(orders.len() >= 6, "{set} {}: {orders:?}", recording.subject);
            let straight = found.windows(2).any(|p| {
                let both = [Some(Intent::Open), Some(Intent::Close)];
                both.contains(&p[0].label) && both.contains(&p[1].label)
            });
            assert_eq!(straight, direct, "{set} {}", recording.subject);
        }
    }
}

/// The recordings with labels shifted by the lag of their data set.
fn trials(library: &Library) -> Vec<Trial> {
    let trial = |recording: &Recording| {
        let labels = recording.labels_in(Vocabulary::Three);
        let late = std::iter::repeat_n(None, recording.data_set.label_lag());
        Trial {
            data_set: recording.data_set,
            subject: recording.subject.clone(),
            name: recording.name.clone(),
            raw: recording.samples.clone(),
            emg: clean(recording.aligned_samples()).collect(),
            published: None,
            lag_compensated: late.chain(labels).take(recording.samples.len()).collect(),
            other_movement: Vec::new(),
        }
    };
    library.recordings.iter().map(trial).collect()
}

#[test]
fn the_shipped_model_is_above_the_floors_and_no_gesture_is_seen_before_it_is_made() {
    let test = "the_shipped_model_is_above_the_floors_and_no_gesture_is_seen_before_it_is_made";
    let Some(library) = read(test, "roshambo") else {
        return;
    };
    let all = trials(&library);
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/three-class.intent");
    let bytes = std::fs::read(file).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let provenance = &model.header.provenance;
    let left_out = |trial: &Trial| {
        let mut names = provenance.subjects_left_out.iter();
        names.any(|name| name == trial.subject)
    };
    let (trials, training): (Vec<_>, Vec<_>) = all.into_iter().partition(left_out);
    // The model was trained on the others.
    assert!(!trials.is_empty() && !training.is_empty());
    let logits = trials
        .iter()
        .map(|trial| integer_logits(&model, &trial.emg).unwrap());
    let own = Candidate {
        name: "model".to_owned(),
        looks_back: true,
        logits: logits.collect(),
    };
    let detector = EnergyDetector::fit(&training).unwrap();
    let candidates = [own, constant(&trials), detector.candidate(&trials)];
    let truths = [Truth::LagCompensated];
    let scores = score_all(&candidates, &trials, Vocabulary::Three, &truths).unwrap();
    let of = |model: &str, look_ahead: LookAhead| {
        let mut scores = scores.iter();
        scores
            .find(|score| score.model == model && score.look_ahead == look_ahead)
            .unwrap()
    };
    let balanced = |score: &Score| Measure::BalancedAccuracy.mean(score).unwrap().mean;
    let (constant, energy) = (of(CONSTANT, LookAhead::None), of(ENERGY, LookAhead::None));
    assert!((balanced(constant) - 1.0 / 3.0).abs() < 1e-9);
    assert_eq!(
        (
            constant.events.recognised,
            constant.events.flicker.unwrap().mean
        ),
        (0, 0.0)
    );
    // Ten gestures a recording, of which the first is often cut.
    let most = 10 * trials.len();
    assert!((most - trials.len()..=most).contains(&constant.events.gestures));
    for look_ahead in LookAhead::ALL {
        let score = of("model", look_ahead);
        assert!(balanced(score) > balanced(energy) && balanced(energy) > balanced(constant));
        let difference = Difference::of(Measure::Recognition, score, constant).unwrap();
        assert!(difference.mean.mean > 0.3, "{difference:?}");
        // Two people show nothing, however clear their numbers.
        assert_eq!((difference.people, difference.is_shown()), (2, false));
        // The hand moves 50 ms or more before a label of the newest patch, and 0.25 s before one with look-ahead.
        let latency = score.events.latency.unwrap();
        let Latency::Ms(median) = latency.median else {
            panic!("{latency:?}")
        };
        let least = if look_ahead == LookAhead::None {
            50.0
        } else {
            250.0
        };
        assert!(
            (least..1000.0).contains(&median),
            "{look_ahead:?}: {median}"
        );
    }
}

/// The table of docs/decisions.md: the shipped model with several lead-ins, on the people that it left out.
#[test]
#[ignore = "a measurement of some minutes"]
fn the_lead_in_decides_the_first_labels() {
    let test = "the_lead_in_decides_the_first_labels";
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/three-class.intent");
    let bytes = std::fs::read(file).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let mut all = Vec::new();
    for set in ["cote-allard", "ss-stm", "roshambo", "myo-readings"] {
        let Some(library) = read(test, set) else {
            return;
        };
        let provenance = &model.header.provenance;
        all.extend(trials(&library).into_iter().filter(|trial| {
            let labelled = trial.lag_compensated.iter().any(Option::is_some);
            let mut names = provenance.subjects_left_out.iter();
            labelled && names.any(|name| name == trial.subject)
        }));
    }
    let with = |name: &str, lead: fn(&[CleanSample]) -> Vec<CleanSample>| {
        let logits = |trial: &Trial| {
            let stream = [lead(&trial.emg), trial.emg.clone()].concat();
            let before = (stream.len() - trial.emg.len()) / PATCH;
            let rows = outputs(&model, stream.as_chunks::<PATCH>().0).unwrap();
            rows[before..].to_vec()
        };
        Candidate {
            name: name.to_owned(),
            looks_back: true,
            logits: all.iter().map(logits).collect(),
        }
    };
    let candidates = [
        with("first 100 samples", |emg| first(emg, 100)),
        with("first patch", |emg| first(emg, PATCH)),
        with("first sample", |emg| first(emg, 1)),
        with("zeros", |_| vec![CleanSample::default(); WINDOW]),
        with("none", |_| Vec::new()),
    ];
    let truths = [Truth::LagCompensated];
    let scores = score_all(&candidates, &all, Vocabulary::Three, &truths).unwrap();
    let with_all_rows = || scores.iter().filter(|s| s.look_ahead == LookAhead::AllRows);
    println!("{} recordings", all.len());
    for score in with_all_rows() {
        let mean = |measure: Measure| measure.mean(score).map_or(f64::NAN, |of| of.mean);
        println!(
            "{:18} {:12} balanced {:.3} TA {:.3} recognised {:.3}",
            score.model,
            score.data_set,
            mean(Measure::BalancedAccuracy),
            mean(Measure::TransitionAccuracy),
            mean(Measure::Recognition)
        );
    }
    let of = |model: &str| {
        with_all_rows()
            .find(|s| s.model == model && s.data_set == ALL)
            .unwrap()
    };
    let measure = Measure::BalancedAccuracy;
    let future = Difference::of(measure, of("first 100 samples"), of("first patch")).unwrap();
    println!("knowledge of the future: {future:?}");
    assert!(future.is_shown());
}

/// The first samples of a recording, repeated to a window.
fn first(emg: &[CleanSample], samples: usize) -> Vec<CleanSample> {
    let lead = emg[..samples].iter().copied().cycle();
    lead.take(WINDOW).collect()
}
