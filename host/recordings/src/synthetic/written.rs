//! Synthetic recordings as files.

use std::path::{Path, PathBuf};

use shared::intent::Intent;
use shared::units::CHANNELS;

use super::{SynthOptions, simulate};
use crate::description::own::MUSCLE_COLUMN;
use crate::recording::Recording;
use execution::run_folder::{RunError, write_whole};

/// Generates the recordings and writes them below a folder, in ReactEMG's csv layout:
/// `s3/s3_synthetic_1.csv`. Returns the paths.
///
/// A further column `synthetic_muscle` holds the intent that the muscle follows at each sample.
///
/// # Errors
/// [`RunError`] with the path that could not be written.
pub fn write(options: &SynthOptions, folder: &Path) -> Result<Vec<PathBuf>, RunError> {
    simulate(options)
        .map(|(recording, muscle)| {
            let person = recording.subject.rsplit('/').next().unwrap_or_default();
            let folder = folder.join(person);
            if let Err(source) = std::fs::create_dir_all(&folder) {
                return Err(RunError::io(&folder, source));
            }
            let path = folder.join(format!("{}.csv", recording.name));
            write_whole(&path, csv(&recording, &muscle).as_bytes())?;
            Ok(path)
        })
        .collect()
}

fn csv(recording: &Recording, muscle: &[Intent]) -> String {
    let channels: String = (0..CHANNELS)
        .map(|channel| format!(",emg_{channel}"))
        .collect();
    let mut text = format!("gt{channels},{MUSCLE_COLUMN}\n");
    for ((sample, label), muscle) in recording.samples.iter().zip(&recording.labels).zip(muscle) {
        text += &label.map_or("-1".to_owned(), |intent| intent.class().to_string());
        for count in sample {
            text += &format!(",{count}");
        }
        text += &format!(",{}\n", muscle.class());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::{LoadOptions, load};
    use crate::synthetic::generate;
    use crate::synthetic::tests::SMALL;

    #[test]
    fn written_recordings_are_read_back_as_generated() {
        let folder = tempfile::tempdir().unwrap();
        let paths = write(&SMALL, folder.path()).unwrap();
        let read = load(folder.path(), &LoadOptions::default())
            .unwrap()
            .recordings;
        let generated = generate(&SMALL);
        assert_eq!(paths.len(), generated.len());
        let parts = |own: Recording| (own.data_set, own.full_name(), own.samples, own.labels);
        let [read, generated] = [read, generated].map(|all| all.into_iter().map(parts));
        assert!(read.eq(generated));
    }
}
