//! Recordings that LibEMG's screen-guided training makes: csv of eight counts, no header, one class a file, which
//! `metadata.json` beside it names, or `collection_details.json` by the number in `C_0_R_1_emg.csv`.

use std::path::Path;

use serde_json::Value;

use crate::labels::motion::Motion;
use crate::readers::path::{existing, with_small_ending};
use crate::recording::Recording;
use execution::bounded_read;

/// Key in LibEMG's metadata for each file.
const CLASS: &str = "\"class_name\"";

/// Key of the classes by number.
const CLASSES: &str = "class_map";

/// Files that name the classes, each with a key that it has.
const NAMES: [(&str, &str); 2] = [
    ("metadata.json", CLASS),
    ("collection_details.json", CLASSES),
];

/// Whether a file names the classes of those beside it.
pub(crate) fn is_metadata(path: &Path, text: &str) -> bool {
    let path = with_small_ending(path);
    let names_classes = |(name, key): &(&str, &str)| path.ends_with(name) && text.contains(key);
    NAMES.iter().any(names_classes)
}

/// Text of the file beside a recording that names its class.
pub(crate) fn metadata(path: &Path) -> Option<String> {
    NAMES.iter().find_map(|(name, _)| {
        let path = existing(path.with_file_name(name))?;
        let text = bounded_read::read_text(&path, bounded_read::RECORDING).ok()?;
        is_metadata(&path, &text).then_some(text)
    })
}

/// Class of a file: by its number, or by its path. The metadata's keys are the recorder's paths, of which the last part
/// is compared.
pub(crate) fn class_name(metadata: &str, path: &Path) -> Option<String> {
    let path = with_small_ending(path);
    let file = path.file_name()?.to_str()?;
    let metadata: Value = serde_json::from_str(metadata).ok()?;
    if let Some(classes) = metadata.get(CLASSES) {
        let (number, _) = file.strip_prefix("C_")?.split_once("_R_")?;
        return classes.get(number)?.as_str().map(str::to_owned);
    }
    let mut entries = metadata.as_object()?.iter();
    let is_own = |(key, _): &(&String, _)| key.rsplit(['/', '\\']).next() == Some(file);
    let (_, entry) = entries.find(is_own)?;
    entry.get("class_name")?.as_str().map(str::to_owned)
}

/// A user's own recording, with the class that the metadata name.
pub(crate) fn labelled(mut recording: Recording, metadata: &str) -> Recording {
    let class = class_name(metadata, &recording.path);
    let motion = class.as_deref().and_then(Motion::of_gesture);
    let motions = vec![motion.unwrap_or(Motion::Unknown); recording.samples.len()];
    match (class, motion) {
        (Some(class), None) => recording.notes.push(format!(
            "no labels: the class {class} of its metadata is unknown"
        )),
        (None, _) => {
            let note = "no labels: its metadata does not name its class";
            recording.notes.push(note.to_owned());
        }
        _ => {}
    }
    recording.with_truth(motions.into_iter().collect())
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;
    use crate::catalogue::DataSet;
    use crate::fixture::{emg, joined, names, rows};

    const METADATA: &str = r#"{"continuous": false,
        "data/alice/R_0_C_1.csv": {"class_idx": 1, "class_name": "Hand_Open"},
        "data\\alice\\R_0_C_2.csv": {"class_idx": 2, "class_name": "No_Motion"},
        "data/alice/R_0_C_3.csv": {"class_idx": 3, "class_name": "Key_Grip"}}"#;

    #[test]
    fn screen_guided_recordings_are_people_by_folder_with_their_classes() {
        let rows = rows(&emg(700, 1), |_, own| joined(own, ",") + "\r");
        let details = r#"{"num_reps": 1, "class_map": {"0": "No_Motion", "1": "Hand_Close"}}"#;
        let library = crate::fixture::read(&[
            ("anna/collection_details.json", details),
            ("anna/C_1_R_0_emg.csv", &rows),
        ]);
        assert_eq!(names(&library), ["own/anna/C_1_R_0_emg"]);
        assert_eq!(library.recordings[0].labels, vec![Some(Intent::Close); 700]);
        assert!(library.ignored.is_empty(), "{:?}", library.ignored);
    }

    #[test]
    fn the_class_comes_from_the_metadata() {
        let read = |file: &str| {
            let path = Path::new("/d/alice").join(file);
            let (samples, labels) = (vec![[1, 2, 3, 4, 5, 6, 7, -8]; 3], vec![None; 3]);
            let own = Recording::new(DataSet::OWN, "", samples, labels);
            labelled(Recording { path, ..own }, METADATA)
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
        }
    }
}
