//! Files of recordings, under the names of every published layout: an accepted recording has a label for each sample
//! and movements inside it, and is the same after writing and reading it.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::{env, fs, process};

use crate::input::Input;
use recordings::Recording;
use recordings::readers::label_file::{Purpose, parse};
use recordings::readers::npy;
pub use recordings::readers::open::{Found, OpenRequest, of_bytes};

/// Paths, one of each layout. No such folder exists: a file that would be read beside another is missing, unless it is
/// one of [`PAIRS`].
#[rustfmt::skip]
pub const PATHS: [&str; 19] = [
    "/nowhere/s3/s3_grasp_1.csv", "/nowhere/s1_r_1/s1_r_1-rock-0-emg.csv",
    "/nowhere/01/1_raw_data_13-12_22.03.16.txt", "/nowhere/12345-1/7.txt", "/nowhere/sub1/M2T1.csv",
    "/nowhere/stream/raw_emg.csv", "/nowhere/EvaluationDataset/Male3/training0/classe_12.dat", "/nowhere/trainingJSON/user3/user3.json",
    "/nowhere/EMG_S1/1_fist.npy", "/nowhere/user10/training/001_fist.npy", "/nowhere/own.npy",
    "/nowhere/subject03_session01_emg.npy", "/nowhere/s3/e2_emg.npy", "/nowhere/EMG_S1/fist_1_x.mat",
    "/nowhere/MyoUP/E2/s1e2.mat", "/nowhere/12345-1/3.txt", "subject03_session01_emg.npy", "s3/e2_emg.npy",
    "trial_1/R_1_C_3.csv",
];

/// Files below [`FOLDER`], each read beside one of the last of the paths.
pub const PAIRS: [&str; 3] = [
    "subject03_session01_ann.npy",
    "s3/e2_ann.npy",
    "trial_1/metadata.json",
];

/// Folder of this process, with the folders of the paths.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = env::temp_dir().join(format!("myointent-fuzz-{}", process::id()));
    for path in PAIRS.map(|name| folder.join(name)) {
        fs::create_dir_all(path.parent().expect("a folder")).expect("a temporary folder");
    }
    folder
});

/// Samples of the longest recording that a file of a few kilobytes may hold: `uci-gestures` names its times, 200 samples a row.
const MOST: usize = 200;

/// Takes a byte for the path, for a pair the length of the file beside it and that file, then the file.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let number = input.below(PATHS.len());
    let alone = PATHS.len() - PAIRS.len();
    if number < alone {
        read(Path::new(PATHS[number]), input.0);
        return;
    }
    let length = u16::from_le_bytes(input.array());
    let beside = input.take(usize::from(length));
    fs::write(FOLDER.join(PAIRS[number - alone]), beside).expect("a file beside it");
    read(&FOLDER.join(PATHS[number]), input.0);
}

fn read(path: &Path, bytes: &[u8]) {
    let request = OpenRequest {
        data_sets: &[],
        alone: true,
    };
    let found = of_bytes(path, bytes, &request);
    if let Err(error) = &found {
        assert!(error.to_string().len() < 1000, "a message of a line");
    }
    let Ok(Found::Recordings(recordings)) = found else {
        return;
    };
    for recording in recordings {
        check(&recording);
        assert!(recording.samples.len() <= MOST * bytes.len());
    }
}

fn check(recording: &Recording) {
    let count = recording.samples.len();
    assert!(count > 0);
    assert_eq!(recording.labels.len(), count, "{}", recording.full_name());
    for movement in &recording.other_movement {
        assert!(!movement.samples.is_empty() && movement.samples.end <= count);
    }
    read_again(recording);
}

/// Writes a recording as label and eight counts a row, which any recording can be, and reads it again.
fn read_again(recording: &Recording) {
    let rows = recording.samples.iter().zip(&recording.labels);
    let data: Vec<u8> = rows
        .flat_map(|(sample, label)| {
            let label = label.map_or(-1, |intent| intent.class() as i8);
            std::iter::once(label).chain(*sample).map(i8::cast_unsigned)
        })
        .collect();
    let bytes = npy::encode("|i1", &[recording.samples.len(), 9], &data);
    let request = OpenRequest {
        data_sets: &[],
        alone: true,
    };
    let Ok(Found::Recordings(again)) = of_bytes(Path::new("/nowhere/s1_x.npy"), &bytes, &request)
    else {
        panic!("{} is not read again", recording.full_name());
    };
    assert_eq!(again[0].samples, recording.samples);
    assert_eq!(again[0].labels, recording.labels);
}

/// Takes a file of labels, true and predicted: csv, text or npy.
pub fn labels(data: &[u8]) {
    let [truth, prediction] =
        [Purpose::Truth, Purpose::Prediction].map(|purpose| parse(data, purpose));
    let Ok(labels) = truth else { return };
    assert!(!labels.is_empty(), "at least one label");
    // A csv may name both kinds of label; a file that names neither reads the same for either purpose.
    if let Ok(prediction) = prediction {
        assert_eq!(prediction.len(), labels.len());
    }
    let text: String = labels
        .iter()
        .map(|label| label.name().to_owned() + "\n")
        .collect();
    let again = parse(text.as_bytes(), Purpose::Truth);
    assert_eq!(again.ok(), Some(labels), "written and read again");
}
