//! Scores of a candidate that follows each change by so many patches.

use super::*;
use shared::model::LookBackLogits;

/// A recording of relax and close in turn, and a model that follows each change after these numbers of patches.
fn followed(changes_after: &[usize]) -> (EvaluatedRecording, Candidate) {
    let (run, classes) = (400, [0, 2]);
    let truth: Vec<Option<Intent>> = (0..run * (changes_after.len() + 1))
        .map(|at| Intent::from_class(classes[at / run % 2]))
        .collect();
    let mut logits = vec![LookBackLogits::default(); truth.len() / 10];
    for (patch, rows) in logits.iter_mut().enumerate() {
        for (back, row) in rows.iter_mut().enumerate() {
            let of = patch.saturating_sub(back);
            let changes = changes_after.iter().enumerate();
            let changes = changes.filter(|(at, late)| of >= (at + 1) * run / 10 + **late);
            row[classes[changes.count() % 2]] = 1.0;
        }
    }
    let recording = EvaluatedRecording {
        emg: vec![[0; 8]; truth.len()],
        lag_compensated: truth,
        ..EvaluatedRecording::made_up("synthetic/1", &[])
    };
    let candidate = Candidate::without_margins("m", true, vec![logits]);
    (recording, candidate)
}

#[test]
fn json_names_the_buffer_of_each_summary_and_is_read_back() {
    let (recording, candidate) = followed(&[1, 2]);
    let (three, none) = (Vocabulary::Three, LookAhead::None);
    let scores = score(&candidate, &[recording], three, none).unwrap();
    let json = serde_json::to_value(&scores).unwrap();
    let buffers = [0, 1, 2].map(|at| json[0]["reference"][at]["buffer"].as_u64());
    assert_eq!(buffers, BUFFERS.map(|buffer| Some(buffer as u64)));
    assert_eq!(serde_json::from_value::<Vec<Score>>(json).unwrap(), scores);
}

#[test]
fn no_label_is_emitted_before_the_time_that_it_is_for() {
    // Half a second of buffer: the second change is inside it at its reference time and outside when emitted.
    let (recording, candidate) = followed(&[2, 8, 2]);
    let (three, look_ahead) = (Vocabulary::Three, LookAhead::SameInstant);
    let scores = score(&candidate, &[recording], three, look_ahead).unwrap();
    let reference: Vec<i32> = scores[0].widest().subjects[0].offsets.clone();
    let latencies = &scores[0].events.subjects[0].latencies;
    // Three changes are followed, of which two begin a gesture; none is left out for being emitted late.
    assert_eq!((reference.len(), latencies.len()), (3, 2));
    assert_eq!(latencies[0] - reference[0], 51);
    assert_eq!(latencies[1] - reference[2], 51);
}
