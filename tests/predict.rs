//! `predict` and then `score`, as the README and the guide show them, on recordings of any length.

#[path = "small.rs"]
#[expect(
    dead_code,
    reason = "nothing is trained here, and nothing synthetic read"
)]
mod small;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::file::random::random_model;
use small::{folder, myointent};

/// A small model file.
fn model(folder: &Path) -> PathBuf {
    let dimensions = Dimensions {
        width: 32,
        layers: 1,
        span: 20,
        vocabulary: Vocabulary::Three,
        other: false,
    };
    let path = folder.join("three-class.intent");
    fs::write(&path, random_model(dimensions, 5).to_bytes().unwrap()).unwrap();
    path
}

/// A recording of so many samples, with labels, as a person's own csv.
fn recording(folder: &Path, samples: usize) -> PathBuf {
    let mut text = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n".to_owned();
    for at in 0..samples {
        let class = [0, 1, 0, 2][at / 400 % 4];
        let value = if at.is_multiple_of(2) { 1 } else { -1 } * if class == 0 { 3 } else { 40 };
        writeln!(text, "{class}{}", format!(",{value}").repeat(8)).unwrap();
    }
    let own = folder.join("anna");
    fs::create_dir_all(&own).unwrap();
    let path = own.join(format!("anna_{samples}.csv"));
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn predict_and_then_score_take_a_recording_of_any_length() {
    let folder = folder("predict");
    let model = model(&folder);
    let labels = folder.join("labels.csv");
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    for samples in [9, 1003, 1009, 1010, 9001] {
        let recording = recording(&folder, samples);
        let [model, recording, out] = [&model, &recording, &labels].map(|path| text(path));
        let _ = fs::remove_file(&labels);
        assert!(myointent(&[
            "predict",
            "--model",
            &model,
            "--recording",
            &recording,
            "--out",
            &out
        ]));
        let rows = fs::read_to_string(&labels).unwrap();
        assert_eq!(rows.lines().count(), 1 + samples);
        assert!(
            myointent(&[
                "score",
                "--truth",
                &recording,
                "--prediction",
                &out,
                "--delay",
                "51"
            ]),
            "{samples}"
        );
    }
}
