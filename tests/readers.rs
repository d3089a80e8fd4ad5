//! Readers of a user's own recordings, and of files that look like published ones: people, columns, and the words of
//! refusals. All inputs are made here.

#[path = "readers/columns.rs"]
mod columns;

use std::fmt::Write as _;
use std::path::Path;

use recordings::{Library, LoadOptions, Recording, load, npy};
use shared::intent::Intent;
use shared::units::Sample;
use tempfile::TempDir;

/// Writes a folder with these files in it.
fn folder<T: AsRef<[u8]>>(files: &[(&str, T)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

fn read(path: &Path) -> Library {
    load(path, &LoadOptions::default()).unwrap()
}

fn people(path: &Path) -> Vec<String> {
    read(path).subjects()
}

/// Returns sample `at` of a person: noise without repeats.
fn sample(person: u32, at: u32) -> Sample {
    std::array::from_fn(|channel| {
        let mixed = (at * 8 + channel as u32 + 1_000_003 * person).wrapping_mul(2_654_435_761);
        (mixed >> 24) as u8 as i8 / 4
    })
}

const HEADER: &str = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7";

/// Returns 700 samples of a person, rest and a fist in turn.
fn own(person: u32) -> String {
    let mut text = format!("{HEADER}\n");
    for at in 0..700 {
        let label = if at / 100 % 2 == 0 { 0 } else { 2 };
        writeln!(text, "{label},{}", row(&sample(person, at), ",")).unwrap();
    }
    text
}

fn row(sample: &Sample, separator: &str) -> String {
    let values: Vec<String> = sample.iter().map(i8::to_string).collect();
    values.join(separator)
}

/// Returns 700 rows without header.
fn bare(person: u32, separator: &str) -> String {
    (0..700)
        .map(|at| row(&sample(person, at), separator) + "\r\n")
        .collect()
}

#[test]
fn the_folder_is_the_person_whatever_the_files_are_called() {
    let two = folder(&[("anna/s1_grasp.csv", own(1)), ("bob/s1_grasp.csv", own(2))]);
    assert_eq!(people(two.path()), ["react-emg/anna", "react-emg/bob"]);
    let underscored = folder(&[
        ("subject_1/subject_1_a.csv", own(1)),
        ("subject_2/subject_2_a.csv", own(2)),
    ]);
    assert_eq!(
        people(underscored.path()),
        ["react-emg/subject_1", "react-emg/subject_2"]
    );
    let numbered = folder(&[("P01/trial1.csv", own(1)), ("P02/trial1.csv", own(2))]);
    assert_eq!(people(numbered.path()), ["react-emg/P01", "react-emg/P02"]);
}

#[test]
fn one_person_is_the_same_whichever_folder_is_asked_for() {
    let study = folder(&[
        ("study/anna/monday/1.csv", own(1)),
        ("study/anna/2026-11-25/1.csv", own(2)),
        ("study/bob/session_1/1.csv", own(3)),
    ]);
    assert_eq!(people(study.path()), ["react-emg/anna", "react-emg/bob"]);
    for below in ["study/anna", "study/anna/monday", "study/anna/monday/1.csv"] {
        assert_eq!(
            people(&study.path().join(below)),
            ["react-emg/anna"],
            "{below}"
        );
    }
    let names: Vec<String> = read(study.path())
        .recordings
        .iter()
        .map(|own| own.full_name())
        .collect();
    assert_eq!(
        names,
        [
            "react-emg/anna/2026-11-25/1",
            "react-emg/anna/monday/1",
            "react-emg/bob/session_1/1"
        ]
    );
}

#[test]
fn people_of_one_name_in_two_folders_are_two() {
    let groups = folder(&[
        ("lab/anna/1.csv", own(1)),
        ("lab/bob/1.csv", own(2)),
        ("home/anna/1.csv", own(3)),
    ]);
    assert_eq!(
        people(groups.path()),
        [
            "react-emg/home/anna",
            "react-emg/lab/anna",
            "react-emg/lab/bob"
        ]
    );
}

#[test]
fn loose_files_are_of_the_person_of_their_folder_or_of_their_prefix() {
    let anna = folder(&[
        ("anna/113_waveIn.npy", npy_of(1, 8)),
        ("anna/1.csv", own(2).into_bytes()),
    ]);
    assert_eq!(people(&anna.path().join("anna")), ["react-emg/anna"]);
    assert_eq!(
        people(&anna.path().join("anna/113_waveIn.npy")),
        ["react-emg/anna"]
    );
    let published = folder(&[("s3_grasp_1.csv", own(1)), ("s4_grasp_1.csv", own(2))]);
    assert_eq!(people(published.path()), ["react-emg/s3", "react-emg/s4"]);
}

/// Returns an array of so many columns, counts of a person.
fn npy_of(person: u32, columns: usize) -> Vec<u8> {
    let data: Vec<u8> = (0..700)
        .flat_map(|at| {
            sample(person, at)
                .into_iter()
                .cycle()
                .take(columns)
                .collect::<Vec<_>>()
        })
        .map(i8::cast_unsigned)
        .collect();
    npy::encode("|i1", &[700, columns], &data)
}

const METADATA: &str = r#"{"continuous": false,
    "data/R_0_C_0.csv": {"rep_idx": 0, "class_idx": 0, "class_name": "Hand_Close"},
    "data/R_0_C_1.csv": {"rep_idx": 0, "class_idx": 1, "class_name": "No_Motion"}}"#;

#[test]
fn recordings_in_the_layout_of_libemg_are_people_by_folder_and_not_the_published_one() {
    let own = folder(&[
        ("alice/R_0_C_0.csv", bare(1, ",")),
        ("alice/R_0_C_1.csv", bare(2, ",")),
        ("alice/metadata.json", METADATA.to_owned()),
        ("bob/trial_1/R_0_C_0.csv", bare(3, ",")),
        ("bob/trial_1/metadata.json", METADATA.to_owned()),
    ]);
    let library = read(own.path());
    assert_eq!(library.subjects(), ["react-emg/alice", "react-emg/bob"]);
    let labels: Vec<_> = library.recordings.iter().map(|own| own.labels[0]).collect();
    assert_eq!(
        labels,
        [
            Some(Intent::Close),
            Some(Intent::Relax),
            Some(Intent::Close)
        ]
    );
}

/// Returns a text of `myo-readings`: rest and a fist in turn.
fn fist(person: u32) -> String {
    let label = |at: u32| if (at / 100).is_multiple_of(2) { 0 } else { 7 };
    (0..700)
        .map(|at| format!("{},{}\n", row(&sample(person, at), ","), label(at)))
        .collect()
}

#[test]
fn a_left_hand_of_myo_readings_is_mirrored_and_of_the_same_person() {
    let both = folder(&[
        ("_readings_left_hand/12345-1/7.txt", fist(1)),
        ("_readings_right_hand/12345-1/7.txt", fist(2)),
        ("_readings_right_hand/23456-1/7.txt", fist(3)),
    ]);
    let library = read(both.path());
    assert_eq!(
        library.subjects(),
        ["myo-readings/12345", "myo-readings/23456"]
    );
    let [left, right, _] = &library.recordings[..] else {
        panic!("three recordings");
    };
    let read = sample(1, 5);
    assert_eq!(
        left.samples[5],
        std::array::from_fn(|channel| read[(14 - channel) % 8])
    );
    assert_eq!(right.samples[5], sample(2, 5));
    assert_ne!(left.full_name(), right.full_name());
    assert!(
        left.notes.iter().any(|note| note.contains("mirrored")),
        "{:?}",
        left.notes
    );
    // Signals of the left arm are not expected of the right one.
    let alone = folder(&[("_readings_right_hand/12345-1/7.txt", fist(2))]);
    assert_eq!(
        right,
        &Recording {
            path: right.path.clone(),
            ..read_one(alone.path())
        }
    );
}

fn read_one(path: &Path) -> Recording {
    read(path).recordings.remove(0)
}

#[test]
fn an_own_folder_called_left_is_not_mirrored_without_a_word() {
    let own = folder(&[
        ("anna/left/1.csv", own(1)),
        ("anna/links/1.csv", own(2)),
        ("anna/1.csv", own(3)),
    ]);
    let library = read(own.path());
    assert_eq!(library.subjects(), ["react-emg/anna"]);
    let warned =
        |recording: &Recording| recording.notes.iter().any(|note| note.contains("left arm"));
    let warned: Vec<bool> = library.recordings.iter().map(warned).collect();
    assert_eq!(warned, [false, true, true]);
    assert_eq!(library.recordings[1].samples[5], sample(1, 5));
}
