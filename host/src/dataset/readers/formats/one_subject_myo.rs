//! `one-subject-myo`: csv of eight whole numbers, no header; classes in `metadata.json` beside it.

use std::path::Path;

use serde_json::Value;
use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;

use crate::dataset::readers::error::{Damage, Fault};
use crate::dataset::readers::path::folder;
use crate::dataset::readers::table;
use crate::dataset::recording::{DataSet, Recording, Timing};

/// A file whose hold starts late, and the sample at which it does.
const LATE_HOLD: (&str, usize) = ("trial_1/R_1_C_3.csv", 60);

/// A file of the set that no metadata name: rest and gestures, unlabelled.
const STREAM: &str = "stream/raw_emg.csv";

/// Whether a csv of the layout belongs to the set: its metadata name a class of theirs, or its name is known.
pub(crate) fn is_recording(path: &Path, metadata: Option<&str>) -> bool {
    metadata.is_some_and(|text| text.contains("\"class_name\"")) || path.ends_with(STREAM)
}

/// Reads a recording; `metadata` is the text of the `metadata.json` in its folder, if there is one.
pub(crate) fn read(path: &Path, text: &str, metadata: Option<&str>) -> Result<Recording, Damage> {
    let misplaced = || Damage::of_file(Fault::Path("trial_1/R_0_C_3.csv"));
    let file = path
        .file_name()
        .and_then(|n| n.to_str())
        .ok_or_else(misplaced)?;
    let session = folder(path, 1).unwrap_or_default();
    let samples = table::counts(text)?;
    let class = metadata.and_then(|text| class_name(text, file));
    let intent = class.as_deref().map(intent).transpose()?.flatten();
    let mut labels = vec![intent; samples.len()];
    let mut notes = Vec::new();
    if class.is_none() {
        notes.push("no labels: no metadata.json names its class".to_owned());
    } else if path.ends_with(LATE_HOLD.0) {
        let before = LATE_HOLD.1.min(labels.len());
        labels[..before].fill(None);
        notes.push("the hold starts 0.3 s late; unlabelled until then".to_owned());
    }
    Ok(Recording {
        data_set: DataSet::OneSubjectMyo,
        subject: "one-subject-myo/1".to_owned(),
        name: format!("{session}/{}", file.trim_end_matches(".csv")),
        path: path.to_owned(),
        samples,
        labels,
        notes,
        other_movement: Vec::new(),
        timing: Timing::Cues,
        wearer: Normalizer::new(),
    })
}

/// The class of a file: the metadata's keys are the recorder's paths, of which the last part is compared.
fn class_name(metadata: &str, file: &str) -> Option<String> {
    let metadata: Value = serde_json::from_str(metadata).ok()?;
    let (_, entry) = metadata
        .as_object()?
        .iter()
        .find(|(key, _)| key.rsplit('/').next() == Some(file))?;
    entry.get("class_name")?.as_str().map(str::to_owned)
}

fn intent(class: &str) -> Result<Option<Intent>, Damage> {
    match class {
        "No_Motion" => Ok(Some(Intent::Relax)),
        "Hand_Open" => Ok(Some(Intent::Open)),
        "Hand_Close" => Ok(Some(Intent::Close)),
        "Wrist_Flexion" => Ok(Some(Intent::WaveIn)),
        "Wrist_Extension" => Ok(Some(Intent::WaveOut)),
        other => {
            let expected = "No_Motion, Hand_Open, Hand_Close, Wrist_Flexion, Wrist_Extension";
            Err(Damage::of_file(Fault::Label {
                expected,
                found: other.to_owned(),
            }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METADATA: &str = r#"{"continuous": false,
        "data/subject1/sgt/trial_1/R_1_C_3.csv": {"class_idx": 3, "class_name": "Wrist_Extension"}}"#;

    #[test]
    fn the_class_comes_from_the_metadata() {
        let text = "1,2,3,4,5,6,7,-8\r\n".repeat(100);
        let read = |path: &str| read(Path::new(path), &text, Some(METADATA)).unwrap();
        let hold = read("/d/trial_2/R_1_C_3.csv");
        assert_eq!(hold.labels, [Some(Intent::WaveOut); 100]);
        let late = read("/d/trial_1/R_1_C_3.csv");
        assert_eq!(
            (late.labels[59], late.labels[60]),
            (None, Some(Intent::WaveOut))
        );
        let unknown = read("/d/stream/raw_emg.csv");
        assert!(!unknown.has_labels());
        assert_eq!(unknown.samples[0], [1, 2, 3, 4, 5, 6, 7, -8]);
    }
}
