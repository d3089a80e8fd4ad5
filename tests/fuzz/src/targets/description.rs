//! Descriptions of recordings: any text beside any table, and what is written by looking at any table.

use std::fs;
use std::path::PathBuf;
use std::process;

use recordings::description::draft::describe;
use recordings::{LoadError, LoadOptions, load};

/// Name of the recording, below the folder of a person.
const FILE: &str = "anna/1.csv";

/// Takes a description, a byte of zero, and a table; without a description one is written.
pub fn run(data: &[u8]) {
    let end = data.iter().position(|byte| *byte == 0);
    let (description, table) = data.split_at(end.unwrap_or(0));
    let folder = folder();
    let own = folder.join("recordings.toml");
    fs::write(folder.join(FILE), table.get(1..).unwrap_or(&[])).expect("a temporary file");
    let _ = fs::remove_file(&own);
    let is_written = description.is_empty();
    if !is_written {
        fs::write(&own, description).expect("a temporary file");
    } else if describe(&folder, None).is_err() {
        return;
    }
    match load(&folder, &LoadOptions::default()) {
        Ok(library) => {
            for recording in &library.recordings {
                let samples = recording.samples.len();
                assert_eq!(recording.labels.len(), samples, "a label a sample");
                let mut others = recording.other_movement.iter();
                assert!(others.all(|movement| movement.samples.end <= samples));
            }
        }
        Err(error) => {
            let is_refused = matches!(error, LoadError::Description { .. });
            assert!(!is_written || !is_refused, "written, and refused: {error}");
        }
    }
}

/// Folder of this process, with one person.
fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("myointent-description-{}", process::id()));
    fs::create_dir_all(folder.join("anna")).expect("a temporary folder");
    folder
}
