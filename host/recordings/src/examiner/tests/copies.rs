//! Samples of another recording.

use super::*;

#[test]
fn equal_samples_count_once_whatever_their_folder() {
    let text = counts(&emg(4000, 1));
    let relabelled = text.replace("\n2,", "\n1,");
    let both = |path, other| read(&[("anna/anna_1.csv", &text), (path, other)]);
    for copy in [
        "anna/.ipynb_checkpoints/anna_1-checkpoint.csv",
        "anna/anna_1 (conflicted copy).csv",
        "backup/anna/anna_1.csv",
        "anna/anna_0.csv",
    ] {
        let library = both(copy, &text);
        let found = (library.recordings.len(), library.repeats.len());
        assert_eq!(found, (1, 1), "{copy}");
        let kept = &library.recordings[0].path;
        let is_first = copy == "anna/anna_0.csv" || kept.ends_with("anna/anna_1.csv");
        assert!(is_first, "{copy}");
    }
    let other_labels = both("anna/anna_2.csv", &relabelled);
    assert!(first(&other_labels).contains("other labels"));
    let library = both("bob/bob_1.csv", &text);
    let found = &groups(&library)[0].finding;
    assert!(found.what.contains("another person's name"), "{found}");
    assert_eq!(found.severity, crate::Severity::Serious);
}

#[test]
fn a_part_of_a_recording_is_left_out_and_an_overlap_is_told() {
    let samples = emg(8000, 1);
    let overlapping = [&samples[6000..], &emg(5000, 9)].concat();
    for (other, recordings, kind) in [
        (&samples[1003..4000], 1, "copy"),
        (&overlapping, 2, "overlap"),
    ] {
        let files = [
            ("anna/anna_1.csv", counts(&samples)),
            ("anna/anna_2.csv", counts(other)),
        ];
        let library = read(&files);
        let found = (library.recordings.len(), kinds(&library));
        assert_eq!(found, (recordings, vec![kind]));
    }
}
