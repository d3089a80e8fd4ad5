//! `roshambo`: pairs of npy files, samples (n, 8) of integers and one name of a gesture per sample.
//!
//! `scissor` is outside the six classes and stays in place as other movement: cutting it out would
//! leave no window that ends within the gesture after it.

use std::path::Path;

use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;
use shared::units::CHANNELS;

use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault, LoadError};
use crate::readers::npy::{self, Array, Values};
use crate::readers::path::stem;
use crate::readers::table;
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording, Timing};

/// Whether an array holds samples of the set: whole numbers, (n, 8), in a file `subject*_emg.npy`.
pub(crate) fn is_samples(path: &Path, array: &Array) -> bool {
    matches!(array.shape[..], [_, CHANNELS])
        && matches!(array.values, Values::Numbers(_))
        && array.descr.contains('i')
        && stem(path).is_some_and(|name| name.starts_with("subject") && name.ends_with("_emg"))
}

/// Reads the samples at `path` with the annotations of the same name beside it.
pub(crate) fn read(path: &Path, array: &Array) -> Result<Recording, LoadError> {
    let damage = |damage: Damage| damage.in_file(path);
    let whole = |fault| damage(Damage::of_file(fault));
    let misplaced = || {
        whole(Fault::Path {
            set: DataSet::Roshambo.name(),
            example: "subject03_session01_emg.npy",
        })
    };
    let name = stem(path)
        .and_then(|stem| stem.strip_suffix("_emg"))
        .ok_or_else(misplaced)?;
    let (person, session) = name.split_once('_').ok_or_else(misplaced)?;
    let person = person.strip_prefix("subject").ok_or_else(misplaced)?;

    let samples = table::samples(array).map_err(damage)?;
    let (partner, annotations) = npy::partner(path, &format!("{name}_ann.npy"))?;
    let motions = motions(&annotations).map_err(|damage| damage.in_file(&partner))?;
    let GroundTruth {
        labels,
        other_movement,
    } = motions.into_iter().collect();
    if labels.len() != samples.len() {
        let fault = Fault::LabelCount {
            samples: samples.len(),
            labels: labels.len(),
        };
        return Err(Damage::of_file(fault).in_file(&partner));
    }
    Ok(Recording {
        data_set: DataSet::Roshambo,
        subject: format!("roshambo/{person}"),
        name: session.to_owned(),
        path: path.to_owned(),
        samples,
        labels,
        notes: notes(person, session),
        other_movement,
        timing: Timing::Cues,
        findings: Vec::new(),
        wearer: Normalizer::new(),
    })
}

fn motions(array: &Array) -> Result<Vec<Motion>, Damage> {
    let Values::Text(names) = &array.values else {
        let expected = "one gesture's name per sample";
        return Err(Damage::of_file(Fault::Array {
            expected,
            found: array.describe(),
        }));
    };
    names
        .iter()
        .enumerate()
        .map(|(index, name)| match name.as_str() {
            "none" => Ok(Motion::RELAX),
            "paper" => Ok(Motion::Intent(Intent::Open)),
            "rock" => Ok(Motion::Intent(Intent::Close)),
            "scissor" => Ok(Motion::Other(MovementKind::TwoFingers)),
            other => {
                let byte = array.byte_of_row(index);
                let expected = "none, paper, rock, scissor";
                Err(Damage::at_byte(
                    byte,
                    Fault::Label {
                        expected,
                        found: other.to_owned(),
                    },
                ))
            }
        })
        .collect()
}

fn notes(person: &str, session: &str) -> Vec<String> {
    let note = match (person, session) {
        ("05", _) => "weak gestures: 1.4 to 1.9 times rest",
        ("07", "session03") => "paper and scissor are not above rest",
        ("07", _) => "paper and scissor are little above rest",
        _ => return Vec::new(),
    };
    vec![note.to_owned()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::movement::Movement;

    /// Four samples, each channel the number of the sample, with these annotations.
    fn read_with(annotations: &[u8], count: usize, tag: &str) -> Result<Recording, LoadError> {
        let folder =
            std::env::temp_dir().join(format!("myointent-roshambo-{tag}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("subject07_session03_emg.npy");
        let data: Vec<u8> = (0..4i64).flat_map(|n| n.to_le_bytes().repeat(8)).collect();
        let array = npy::parse(&npy::encode("<i8", &[4, 8], &data)).unwrap();
        let partner = folder.join("subject07_session03_ann.npy");
        std::fs::write(partner, npy::encode("|S7", &[count], annotations)).unwrap();
        let result = read(&path, &array);
        std::fs::remove_dir_all(&folder).unwrap();
        result
    }

    #[test]
    fn scissor_is_unlabelled_and_stays_in_place() {
        let annotations = b"none\0\0\0paper\0\0rock\0\0\0scissor";
        let recording = read_with(annotations, 4, "names").unwrap();
        let expected = [
            Some(Intent::Relax),
            Some(Intent::Open),
            Some(Intent::Close),
            None,
        ];
        assert_eq!(recording.labels, expected);
        let scissors = Movement::new(MovementKind::TwoFingers, 3..4);
        assert_eq!(recording.other_movement, [scissors]);
        assert_eq!(recording.samples[3], [3; 8]);
        assert_eq!(
            (recording.subject.as_str(), recording.notes.len()),
            ("roshambo/07", 1)
        );
    }

    #[test]
    fn unknown_names_and_other_counts_are_refused() {
        let error = read_with(b"none\0\0\0lizard\0", 2, "lizard")
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("lizard") && error.contains("_ann.npy, byte"),
            "{error}"
        );
        let error = read_with(b"none\0\0\0", 1, "count")
            .unwrap_err()
            .to_string();
        assert!(error.contains("1 labels for 4 samples"), "{error}");
    }
}
