//! Set with broken files.

use std::collections::BTreeSet;

use recordings::{LoadOptions, Recording, load};

use super::{folder, read};

#[test]
fn myo_readings_leaves_out_its_four_broken_files_and_says_where() {
    let test = "myo_readings_leaves_out_its_four_broken_files_and_says_where";
    let Some(library) = read(test, "myo-readings") else {
        return;
    };
    // Files 3 to 6 are motions outside the six classes; one holds the labels of another motion.
    let outside = |r: &&Recording| ["/3", "/4", "/5", "/6"].iter().any(|n| r.name.ends_with(n));
    let (outside, six_classes): (Vec<_>, Vec<_>) = library.recordings.iter().partition(outside);
    assert_eq!(
        (library.subjects().len(), six_classes.len(), outside.len()),
        (32, 388, 128)
    );
    assert!(six_classes.iter().all(|r| r.other_movement.is_empty()));
    let labelled: Vec<_> = outside.iter().filter(|r| r.has_labels()).collect();
    assert_eq!(labelled.len(), 1);
    assert_eq!(labelled[0].full_name(), "myo-readings/69069/1/3");
    // All files are of one sitting of 32 people; the labels of four people drift, which leaves 16 files unmarked.
    let marked = outside.iter().filter(|r| !r.other_movement.is_empty());
    assert_eq!(marked.count(), 127 - 16);
    let found: Vec<_> = library.skipped.iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), 4);
    for (error, line) in found.iter().zip([12322, 1032, 1996, 1347]) {
        assert!(error.contains(&format!("line {line}")), "{error}");
    }
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
    let Some(library) = read(test, "myo-readings") else {
        return;
    };
    let polled: BTreeSet<_> = library
        .recordings
        .iter()
        .filter(|r| r.findings.iter().any(|finding| finding.kind() == "polled"))
        .map(|r| r.subject.as_str())
        .collect();
    assert_eq!(polled, BTreeSet::from(["myo-readings/69069"]));
    for recording in &library.recordings {
        let drifts = ["32185", "35622", "46666", "60186"];
        let drifts = drifts.iter().any(|id| recording.subject.ends_with(id));
        let rest = recording.name.ends_with("/0");
        if !recording.other_movement.is_empty() {
            assert!(!drifts, "{}", recording.path.display());
            continue;
        }
        assert_eq!(
            recording.has_labels(),
            !drifts || rest,
            "{}",
            recording.path.display()
        );
    }
}
