//! Published recordings: counts, labels, lag and splices are as their description states. The recordings themselves are
//! outside the repository.

#[path = "recordings/described.rs"]
mod described;
#[path = "recordings/labels.rs"]
mod labels;
#[path = "recordings/myo_readings.rs"]
mod myo_readings;
#[path = "recordings/placement.rs"]
mod placement;
#[path = "recordings/sets.rs"]
mod sets;
#[path = "recordings/shipped_model.rs"]
mod shipped_model;

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use myointent_tests::{data, skip};
use recordings::labels::compensation::Compensation;
use recordings::splice::{SpliceOptions, splice};
use recordings::split::predefined::PredefinedSplit;
use recordings::{Library, LoadOptions, Recording, load, runs};
use shared::intent::Intent;
use shared::units::Sample;

/// Returns the folder of one set; without it, prints the skip of the test.
fn folder(test: &str, set: &str) -> Option<PathBuf> {
    let folder = data(test)?.join(set);
    if folder.is_dir() {
        return Some(folder);
    }
    let missing = format!("no folder {}: see docs/recordings.md", folder.display());
    skip(test, &missing);
    None
}

/// Returns a published set, which all tests read once together.
fn read(test: &str, set: &str) -> Option<&'static Library> {
    static SETS: Mutex<BTreeMap<PathBuf, &OnceLock<Library>>> = Mutex::new(BTreeMap::new());
    let folder = folder(test, set)?;
    let own: &OnceLock<Library> = {
        let mut sets = SETS.lock().unwrap();
        let own = sets.entry(folder.clone());
        own.or_insert_with(|| Box::leak(Box::default()))
    };
    let as_recorded = LoadOptions {
        as_recorded: true,
        ..LoadOptions::default()
    };
    let load = || load(&folder, &as_recorded).expect("the published set is readable");
    Some(own.get_or_init(load))
}

/// The samples of a recording as recorded, in the common frame of all sets.
fn aligned_samples(recording: &Recording) -> Vec<Sample> {
    let mut samples = recording.samples.clone();
    recording.data_set.align(&mut samples);
    samples
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
        let late =
            |own: &Recording| own.compensated(Compensation::Constant(own.data_set.label_lag()));
        let sources: Vec<_> = library.recordings.iter().map(late).collect();
        let sources: Vec<_> = sources.iter().collect();
        let options = SpliceOptions {
            samples: 24_000,
            count: 1,
            other: false,
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

#[test]
fn everybody_of_the_predefined_split_is_in_the_recordings() {
    let test = "everybody_of_the_predefined_split_is_in_the_recordings";
    for (set, predefined) in PredefinedSplit::all() {
        let Some(library) = read(test, set) else {
            return;
        };
        let subjects = library.subjects();
        let people = [
            &predefined.checkpoint,
            &predefined.settings,
            &predefined.test,
        ];
        for person in people.into_iter().flatten() {
            let name = format!("{set}/{person}");
            assert!(subjects.contains(&name), "{name} is not in the recordings");
        }
    }
}
