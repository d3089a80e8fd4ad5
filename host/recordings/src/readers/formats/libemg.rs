//! Recordings that LibEMG's screen-guided training makes: csv of eight counts, no header, one class a file, which
//! `metadata.json` beside it names. The published ones of `one-subject-myo` have a reader of their own.

use std::path::Path;

use serde_json::Value;
use shared::intent::Intent;
use shared::units::Sample;

use super::react_emg::own;
use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::Damage;
use crate::recording::movement::MovementKind;
use crate::recording::{DataSet, Recording};
use execution::bounded_read;

/// Key in LibEMG's metadata for each file.
pub(crate) const CLASS: &str = "\"class_name\"";

/// Text of the `metadata.json` beside a file, if it names classes.
pub(crate) fn metadata(path: &Path) -> Option<String> {
    let path = path.with_file_name("metadata.json");
    let text = bounded_read::read_text(&path, bounded_read::RECORDING).ok()?;
    text.contains(CLASS).then_some(text)
}

/// Class of a file. The metadata's keys are the recorder's paths, of which the last part is compared.
pub(crate) fn class_name(metadata: &str, path: &Path) -> Option<String> {
    let file = path.file_name()?.to_str()?;
    let metadata: Value = serde_json::from_str(metadata).ok()?;
    let (_, entry) = metadata
        .as_object()?
        .iter()
        .find(|(key, _)| key.rsplit(['/', '\\']).next() == Some(file))?;
    entry.get("class_name")?.as_str().map(str::to_owned)
}

/// Motion of a class by LibEMG's names of gestures; none for an unknown name.
pub(crate) fn motion(class: &str) -> Option<Motion> {
    let class = class.to_lowercase().replace([' ', '-'], "_");
    let motion = match class.as_str() {
        "no_motion" | "no_movement" | "rest" | "relax" => Motion::RELAX,
        "hand_open" | "open" => Motion::Intent(Intent::Open),
        "hand_close" | "close" | "fist" => Motion::Intent(Intent::Close),
        "wrist_flexion" => Motion::Intent(Intent::WaveIn),
        "wrist_extension" => Motion::Intent(Intent::WaveOut),
        "pinch" | "pinch_grip" => Motion::Intent(Intent::Pinch),
        "pronation" | "wrist_pronation" => Motion::Other(MovementKind::Pronation),
        "supination" | "wrist_supination" => Motion::Other(MovementKind::Supination),
        "radial_deviation" => Motion::Other(MovementKind::RadialDeviation),
        "ulnar_deviation" => Motion::Other(MovementKind::UlnarDeviation),
        _ => return None,
    };
    Some(motion)
}

/// A user's own recording, with the class that the metadata name.
pub(crate) fn read(path: &Path, samples: Vec<Sample>, metadata: &str) -> Result<Recording, Damage> {
    let class = class_name(metadata, path);
    let motion = class.as_deref().map(|class| (class, motion(class)));
    let truth: GroundTruth = samples
        .iter()
        .map(|_| {
            motion
                .and_then(|(_, motion)| motion)
                .unwrap_or(Motion::Unknown)
        })
        .collect();
    let mut recording = own(path, DataSet::ReactEmg, samples, truth)?;
    match motion {
        Some((class, None)) => recording.notes.push(format!(
            "no labels: the class {class} of metadata.json is none of the six intents"
        )),
        None => recording
            .notes
            .push("no labels: metadata.json does not name its class".to_owned()),
        Some(_) => {}
    }
    Ok(recording)
}

#[cfg(test)]
mod tests {
    use super::*;

    const METADATA: &str = r#"{"continuous": false,
        "data/alice/R_0_C_1.csv": {"class_idx": 1, "class_name": "Hand_Open"},
        "data\\alice\\R_0_C_2.csv": {"class_idx": 2, "class_name": "No_Motion"},
        "data/alice/R_0_C_3.csv": {"class_idx": 3, "class_name": "Key_Grip"}}"#;

    #[test]
    fn the_class_comes_from_the_metadata() {
        let read = |file: &str| {
            let path = Path::new("/d/alice").join(file);
            read(&path, vec![[1, 2, 3, 4, 5, 6, 7, -8]; 3], METADATA).unwrap()
        };
        assert_eq!(read("R_0_C_1.csv").labels, [Some(Intent::Open); 3]);
        assert_eq!(read("R_0_C_2.csv").labels, [Some(Intent::Relax); 3]);
        for (file, note) in [
            ("R_0_C_3.csv", "Key_Grip"),
            ("R_0_C_4.csv", "does not name"),
        ] {
            let recording = read(file);
            assert!(!recording.has_labels());
            assert!(recording.notes[0].contains(note), "{:?}", recording.notes);
            assert_eq!(recording.data_set, DataSet::ReactEmg);
        }
    }
}
