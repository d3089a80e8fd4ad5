//! Published recordings: counts, labels, lag and splices are as their description states. The recordings themselves are
//! outside the repository.

mod described;
mod labels;
mod placement;
mod sets;
mod shipped_model;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock};

use myointent_tests::recorded;
use recordings::split::predefined::PredefinedSplit;
use recordings::{Library, LoadOptions, Recording, load};
use shared::units::Sample;

/// Returns a published set, which all tests read once together.
fn read(set: &str) -> Option<&'static Library> {
    static SETS: Mutex<BTreeMap<PathBuf, &OnceLock<Library>>> = Mutex::new(BTreeMap::new());
    let folder = recorded(set)?;
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

#[test]
fn everybody_of_the_predefined_split_is_in_the_recordings() {
    for (set, predefined) in PredefinedSplit::all() {
        let Some(library) = read(set) else {
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
