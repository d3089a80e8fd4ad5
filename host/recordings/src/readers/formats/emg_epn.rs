//! EMG-EPN-612: one JSON per user, 150 repetitions in `trainingSamples`, 150 in `testingSamples`.
//!
//! Written from the public descriptions of the set, without a copy of it, and tested on small
//! files of the same structure. A repetition has `gestureName`, `emg` with `ch1`..`ch8`, and the place
//! of the gesture as `groundTruth` (0 or 1 per sample) or `groundTruthIndex` (first and last sample,
//! 1 first). `noGesture` has neither and is rest throughout; repetitions without a name are unlabelled.
//! The same user number in the training and the testing part is two people.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;
use shared::units::{CHANNELS, Sample};

use crate::catalogue::DataSet;
use crate::readers::error::{Damage, Fault};
use crate::readers::path::stem;
use crate::readers::table;
use crate::recording::{Recording, Timing};

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

pub(crate) fn read(path: &Path, text: &str) -> Result<Vec<Recording>, Damage> {
    let misplaced = || {
        Damage::of_file(Fault::Path {
            set: DataSet::named("emg-epn-612").name(),
            example: "trainingJSON/user7/user7.json",
        })
    };
    let subject = subject(path).ok_or_else(misplaced)?;
    let user: User = serde_json::from_str(text)
        .map_err(|error| Damage::at_line(error.line(), Fault::Json(error.to_string())))?;
    let parts = [
        ("trainingSamples", user.training),
        ("testingSamples", user.testing),
    ];
    let mut recordings = Vec::new();
    for (part, repetitions) in parts {
        let mut repetitions: Vec<_> = repetitions.into_iter().collect();
        repetitions.sort_by_key(|(key, _)| index(key));
        for (key, repetition) in repetitions {
            let name = format!("{part}/{key}");
            let damage = |fault: Fault| Damage::of_file(Fault::Json(format!("{name}: {fault}")));
            let samples = samples(&repetition).map_err(damage)?;
            let (labels, note) = labels(&repetition, samples.len()).map_err(damage)?;
            recordings.push(Recording {
                data_set: DataSet::named("emg-epn-612"),
                subject: subject.clone(),
                path: path.to_owned(),
                samples,
                labels,
                notes: note.map(str::to_owned).into_iter().collect(),
                other_movement: Vec::new(),
                name,
                timing: Timing::Cues,
                findings: Vec::new(),
                wearer: Normalizer::new(),
            });
        }
    }
    Ok(recordings)
}

/// Subject from the file's name and the part among its folders: `emg-epn-612/training-user7`.
fn subject(path: &Path) -> Option<String> {
    let user = stem(path)?;
    let part = path
        .ancestors()
        .skip(1)
        .filter_map(|folder| folder.file_name()?.to_str())
        .find_map(|folder| {
            ["training", "testing"]
                .into_iter()
                .find(|part| folder.starts_with(part))
        })?;
    Some(format!("emg-epn-612/{part}-{user}"))
}

/// Number `N` of a key `idx_N`, by which repetitions keep the order of recording.
fn index(key: &str) -> usize {
    key.rsplit('_')
        .next()
        .and_then(|number| number.parse().ok())
        .unwrap_or(usize::MAX)
}

fn samples(repetition: &Repetition) -> Result<Vec<Sample>, Fault> {
    let mut channels = Vec::with_capacity(CHANNELS);
    for number in 1..=CHANNELS {
        let name = format!("ch{number}");
        let missing = || Fault::Json(format!("emg has no {name}"));
        channels.push(repetition.emg.get(&name).ok_or_else(missing)?);
    }
    let count = channels[0].len();
    if let Some(other) = channels.iter().find(|channel| channel.len() != count) {
        let found = other.len() as u64;
        return Err(Fault::Length {
            expected: count as u64,
            found,
        });
    }
    (0..count)
        .map(|at| {
            let counts: Vec<f64> = channels.iter().map(|channel| channel[at]).collect();
            table::sample(&counts, 1)
        })
        .collect()
}

type Labels = (Vec<Option<Intent>>, Option<&'static str>);

fn labels(repetition: &Repetition, samples: usize) -> Result<Labels, Fault> {
    let Some(gesture) = &repetition.gesture else {
        return Ok((vec![None; samples], Some("no gesture name: unlabelled")));
    };
    let intent = match gesture.as_str() {
        "noGesture" => return Ok((vec![Some(Intent::Relax); samples], None)),
        "open" => Intent::Open,
        "fist" => Intent::Close,
        "waveIn" => Intent::WaveIn,
        "waveOut" => Intent::WaveOut,
        "pinch" => Intent::Pinch,
        other => {
            let expected = "noGesture, fist, waveIn, waveOut, open, pinch";
            return Err(Fault::Label {
                expected,
                found: other.to_owned(),
            });
        }
    };
    let label = |active| Some(if active { intent } else { Intent::Relax });
    if let Some(active) = repetition.active.as_ref().and_then(numbers) {
        if active.len() != samples {
            return Err(Fault::LabelCount {
                samples,
                labels: active.len(),
            });
        }
        return Ok((
            active
                .into_iter()
                .map(|value| label(value != 0.0))
                .collect(),
            None,
        ));
    }
    if let Some(&[first, last]) = repetition.bounds.as_ref().and_then(numbers).as_deref() {
        // The set was made in MATLAB: positions count from 1 and the last belongs to the gesture.
        let active = |at: usize| (first..=last).contains(&(at as f64 + 1.0));
        return Ok(((0..samples).map(|at| label(active(at))).collect(), None));
    }
    Ok((
        vec![None; samples],
        Some("start and end of the gesture are missing: unlabelled"),
    ))
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
    use super::*;
    use crate::readers::error::Place;

    fn repetition(fields: &str) -> String {
        let channels: Vec<_> = (1..=8)
            .map(|c| format!("\"ch{c}\": [{c}, -{c}, 0, 127]"))
            .collect();
        format!("{{{fields} \"emg\": {{{}}}}}", channels.join(", "))
    }

    fn user(repetitions: &[String]) -> String {
        let repetitions: Vec<_> = repetitions
            .iter()
            .enumerate()
            .map(|(i, t)| format!("\"idx_{}\": {t}", i + 1))
            .collect();
        let repetitions = repetitions.join(",\n");
        format!(
            "{{\"userInfo\": {{\"name\": \"user7\"}},\n\"trainingSamples\": {{{repetitions}}}}}"
        )
    }

    const PATH: &str = "/d/testingJSON/user7/user7.json";

    #[test]
    fn labels_are_the_gesture_where_it_lies_and_rest_around() {
        let text = user(&[
            repetition("\"gestureName\": \"pinch\", \"groundTruth\": [0, 1, 1, 0],"),
            repetition("\"gestureName\": \"fist\", \"groundTruthIndex\": [3, 4],"),
            repetition("\"gestureName\": \"noGesture\","),
            repetition("\"gestureName\": \"open\","),
            repetition(""),
        ]);
        let recordings = read(Path::new(PATH), &text).unwrap();
        let classes = |index: usize| -> Vec<i8> {
            let label = |l: &Option<Intent>| l.map_or(-1, |intent| intent.class() as i8);
            recordings[index].labels.iter().map(label).collect()
        };
        let found: Vec<_> = (0..5).map(classes).collect();
        let none = [-1; 4];
        assert_eq!(found, [[0, 5, 5, 0], [0, 0, 2, 2], [0; 4], none, none]);
        assert_eq!(recordings[0].samples[1], [-1, -2, -3, -4, -5, -6, -7, -8]);
        assert_eq!(recordings[0].subject, "emg-epn-612/testing-user7");
        assert_eq!(recordings[4].name, "trainingSamples/idx_5");
    }

    #[test]
    fn trials_keep_their_order_beyond_nine() {
        let repetitions: Vec<_> = (0..11)
            .map(|_| repetition("\"gestureName\": \"noGesture\","))
            .collect();
        let recordings = read(Path::new(PATH), &user(&repetitions)).unwrap();
        assert_eq!(recordings[9].name, "trainingSamples/idx_10");
    }

    #[test]
    fn faults_name_the_trial_or_the_line() {
        let wrong = user(&[repetition(
            "\"gestureName\": \"fist\", \"groundTruth\": [0, 1],",
        )]);
        let damage = read(Path::new(PATH), &wrong).unwrap_err();
        assert!(
            damage.fault.to_string().contains("trainingSamples/idx_1"),
            "{damage:?}"
        );
        let cut = user(&[repetition("")]);
        let damage = read(Path::new(PATH), &cut[..cut.len() - 4]).unwrap_err();
        assert_eq!(damage.place, Place::Line(2));
        let unknown = user(&[repetition("\"gestureName\": \"wink\",")]);
        assert!(read(Path::new(PATH), &unknown).is_err());
    }
}
