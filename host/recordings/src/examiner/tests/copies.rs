//! Samples of another recording.

use super::*;

#[test]
fn equal_samples_count_once_whatever_their_folder() {
    let text = counts(&emg(4000, 1));
    let other_labels = text.replace("\n2,", "\n1,");
    for copy in [
        "anna/.ipynb_checkpoints/anna_1-checkpoint.csv",
        "anna/anna_1 (conflicted copy).csv",
        "backup/anna/anna_1.csv",
        "anna/anna_0.csv",
    ] {
        let library = read(&[("anna/anna_1.csv", &text), (copy, &text)]);
        assert_eq!(
            (library.recordings.len(), library.repeats.len()),
            (1, 1),
            "{copy}"
        );
        if copy != "anna/anna_0.csv" {
            assert!(
                library.recordings[0].path.ends_with("anna/anna_1.csv"),
                "{copy}"
            );
        }
    }
    let library = read(&[
        ("anna/anna_1.csv", &text),
        ("anna/anna_2.csv", &other_labels),
    ]);
    assert!(groups(&library)[0].finding.what.contains("other labels"));
    let library = read(&[("anna/anna_1.csv", &text), ("bob/bob_1.csv", &text)]);
    let found = &groups(&library)[0].finding;
    assert!(
        found.what.contains("another person's name"),
        "{}",
        found.what
    );
    assert_eq!(found.severity, crate::Severity::Serious);
}

#[test]
fn a_part_of_a_recording_is_left_out_and_an_overlap_is_told() {
    let samples = emg(8000, 1);
    let (whole, part) = (counts(&samples), counts(&samples[1003..4000]));
    let library = read(&[("anna/anna_1.csv", &whole), ("anna/anna_2.csv", &part)]);
    assert_eq!(
        (library.recordings.len(), kinds(&library)),
        (1, vec!["copy"])
    );
    let mut longer = samples[6000..].to_vec();
    longer.extend(emg(5000, 9));
    let library = read(&[
        ("anna/anna_1.csv", &whole),
        ("anna/anna_2.csv", &counts(&longer)),
    ]);
    assert_eq!(
        (library.recordings.len(), kinds(&library)),
        (2, vec!["overlap"])
    );
}
