//! EMG-EPN-612: one JSON per user, 150 repetitions in `trainingSamples`, 150 in `testingSamples`.
//!
//! Written from the public descriptions of the set, without a copy of it, and tested on small
//! files of the same structure. A repetition has `gestureName`, `emg` with `ch1`..`ch8`, and the place
//! of the gesture as `groundTruth` (0 or 1 per sample) or `groundTruthIndex` (first and last sample,
//! 1 first). `noGesture` has neither and is rest throughout; repetitions without a name are unlabelled.
//! The same user number in the training and the testing part is two people.

use std::collections::BTreeMap;

use serde::Deserialize;
use shared::units::{CHANNELS, Sample};

use super::rows::{At, Rows};
use super::words::{Labels, Words};
use crate::labels::motion::Motion;
use crate::readers::error::excerpt::excerpt;
use crate::readers::error::{self, Damage};
use crate::readers::table;

/// Word of rest.
const REST: &str = "noGesture";

#[derive(Deserialize)]
struct User {
    #[serde(default, rename = "trainingSamples")]
    training: BTreeMap<String, Repetition>,
    #[serde(default, rename = "testingSamples")]
    testing: BTreeMap<String, Repetition>,
}

#[derive(Deserialize)]
struct Repetition {
    #[serde(rename = "gestureName")]
    gesture: Option<String>,
    #[serde(rename = "groundTruth")]
    active: Option<serde_json::Value>,
    #[serde(rename = "groundTruthIndex")]
    bounds: Option<serde_json::Value>,
    emg: BTreeMap<String, Vec<f64>>,
}

/// Whether a JSON text is a user of the set.
pub(crate) fn looks_like(text: &str) -> bool {
    text.contains("\"trainingSamples\"") || text.contains("\"testingSamples\"")
}

/// Damage of a user's file in folders that do not say which part it is of.
pub(crate) fn misplaced() -> Damage {
    Damage::of_file(
        "expected the folders and names of emg-epn-612 as published, such as trainingJSON/user7/user7.json",
    )
}

/// Fault of a text that is not the set's JSON.
fn no_json(reason: &str) -> String {
    format!("expected the set's JSON: {}", excerpt(reason))
}

/// A repetition: its name, its rows, and a note where it is unlabelled.
pub(super) type Named = (String, Rows, Option<&'static str>);

/// Repetitions of a user, in the order of recording.
pub(super) fn of(text: &str, labels: &Labels) -> Result<Vec<Named>, Damage> {
    let user: User = serde_json::from_str(text)
        .map_err(|error| Damage::at_line(error.line(), no_json(&error.to_string())))?;
    let parts = [
        ("trainingSamples", user.training),
        ("testingSamples", user.testing),
    ];
    let mut all = Vec::new();
    for (part, repetitions) in parts {
        let mut repetitions: Vec<_> = repetitions.into_iter().collect();
        repetitions.sort_by_key(|(key, _)| index(key));
        for (key, repetition) in repetitions {
            let name = format!("{part}/{key}");
            let damage = |fault: String| Damage::of_file(no_json(&format!("{name}: {fault}")));
            let samples = samples(&repetition).map_err(damage)?;
            let words = words(&repetition, samples.len(), labels).map_err(damage)?;
            let note = words.as_ref().err().copied();
            all.push((name, Rows::of(samples, words.ok(), At::File), note));
        }
    }
    Ok(all)
}

/// Number `N` of a key `idx_N`, by which repetitions keep the order of recording.
fn index(key: &str) -> usize {
    key.rsplit('_')
        .next()
        .and_then(|number| number.parse().ok())
        .unwrap_or(usize::MAX)
}

fn samples(repetition: &Repetition) -> Result<Vec<Sample>, String> {
    let mut channels = Vec::with_capacity(CHANNELS);
    for number in 1..=CHANNELS {
        let channel = repetition.emg.get(&format!("ch{number}"));
        channels.push(channel.ok_or_else(|| no_json(&format!("emg has no ch{number}")))?);
    }
    let count = channels[0].len();
    if let Some(other) = channels.iter().find(|channel| channel.len() != count) {
        let found = other.len();
        return Err(format!(
            "expected {count} values in each channel, found {found}"
        ));
    }
    let row = |at| {
        let counts: Vec<f64> = channels.iter().map(|channel| channel[at]).collect();
        table::sample(&counts, 1)
    };
    (0..count).map(row).collect()
}

/// Words of the samples, or the reason why the repetition is unlabelled.
fn words(
    repetition: &Repetition,
    samples: usize,
    labels: &Labels,
) -> Result<Result<Words, &'static str>, String> {
    let Some(gesture) = &repetition.gesture else {
        return Ok(Err("no gesture name: unlabelled"));
    };
    let active: Vec<bool> = if labels.meaning(gesture)? == Motion::RELAX {
        vec![false; samples]
    } else if let Some(active) = repetition.active.as_ref().and_then(numbers) {
        active.into_iter().map(|value| value != 0.0).collect()
    } else if let Some(&[first, last]) = repetition.bounds.as_ref().and_then(numbers).as_deref() {
        // The set was made in MATLAB: positions count from 1 and the last belongs to the gesture.
        let is_active = |at: usize| (first..=last).contains(&(at as f64 + 1.0));
        (0..samples).map(is_active).collect()
    } else {
        return Ok(Err("start and end of the gesture are missing: unlabelled"));
    };
    if active.len() != samples {
        return Err(error::label_count(samples, active.len()));
    }
    let word = |active| if active { gesture.as_str() } else { REST };
    Ok(Ok(active.into_iter().map(word).collect()))
}

fn numbers(value: &serde_json::Value) -> Option<Vec<f64>> {
    value
        .as_array()?
        .iter()
        .map(serde_json::Value::as_f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use shared::intent::Intent;

    use crate::description::published::PublishedFile;
    use crate::readers::error::LoadError;
    use crate::recording::Recording;

    fn read(text: &str) -> Result<Vec<Recording>, LoadError> {
        let path = Path::new("/d/testingJSON/user7/user7.json");
        let file = PublishedFile::of(path, text.as_bytes()).expect("a path of the set");
        file.read(text.as_bytes())
    }

    /// File of a user with repetitions of these fields, which have ' for ".
    fn user(repetitions: &[&str]) -> String {
        let channels = [1, 2, 3, 4, 5, 6, 7, 8].map(|c| format!("'ch{c}': [{c}, -{c}, 0, 127]"));
        let emg = format!("'emg': {{{}}}", channels.join(", "));
        let numbered = (1..).zip(repetitions);
        let all = numbered.map(|(number, fields)| format!("'idx_{number}': {{{fields} {emg}}}"));
        let all = all.collect::<Vec<_>>().join(",\n");
        let user = format!("{{'userInfo': {{'name': 'user7'}},\n'trainingSamples': {{{all}}}}}");
        user.replace('\'', "\"")
    }

    #[test]
    fn labels_are_the_gesture_where_it_lies_and_rest_around() {
        let mut repetitions = [""; 11];
        repetitions[..4].copy_from_slice(&[
            "'gestureName': 'pinch', 'groundTruth': [0, 1, 1, 0],",
            "'gestureName': 'fist', 'groundTruthIndex': [3, 4],",
            "'gestureName': 'noGesture',",
            "'gestureName': 'open',",
        ]);
        let recordings = read(&user(&repetitions)).unwrap();
        let classes = |own: &Recording| -> Vec<i8> {
            let label = |l: &Option<Intent>| l.map_or(-1, |intent| intent.class() as i8);
            own.labels.iter().map(label).collect()
        };
        let found: Vec<_> = recordings[..5].iter().map(classes).collect();
        let none = [-1; 4];
        assert_eq!(found, [[0, 5, 5, 0], [0, 0, 2, 2], [0; 4], none, none]);
        assert_eq!(recordings[0].samples[1], [-1, -2, -3, -4, -5, -6, -7, -8]);
        assert_eq!(recordings[0].subject, "emg-epn-612/testing-user7");
        // They keep their order beyond nine.
        assert_eq!(recordings[9].name, "trainingSamples/idx_10");
    }

    #[test]
    fn faults_name_the_trial_or_the_line() {
        let short = user(&["'gestureName': 'fist', 'groundTruth': [0, 1],"]);
        let unknown = user(&["'gestureName': 'wink',"]);
        let whole = user(&[""]);
        for (text, words) in [
            (&short[..], "trainingSamples/idx_1"),
            (&unknown, "idx_1: expected a label that is listed"),
            (&whole[..whole.len() - 4], "line 2"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
