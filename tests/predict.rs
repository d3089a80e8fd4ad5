//! Commands `predict` and then `score`, as the README and the guide show them, on recordings of any length; and what
//! another program computes from an exported student.

#[path = "predict/onnx.rs"]
mod onnx;
#[path = "small.rs"]
mod small;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use recordings::{LoadOptions, Recording, load};
use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::file::random::random_model;
use small::{folder, myointent};

/// Writes a small model file.
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

/// Writes a recording of `samples` samples, with labels, as a person's own csv.
fn recording(folder: &Path, samples: usize) -> PathBuf {
    let mut text = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n".to_owned();
    for at in 0..samples {
        let class = [0, 1, 0, 2][at / 400 % 4];
        let amplitude = if class == 0 { 3 } else { 40 };
        let noise = |channel: usize| {
            let mixed = (8 * at + channel) as u32;
            i64::from((mixed ^ (mixed >> 5)).wrapping_mul(2_654_435_761) >> 16)
                % (2 * amplitude + 1)
        };
        let values = (0..8).map(|channel| format!(",{}", noise(channel) - amplitude));
        writeln!(text, "{class}{}", values.collect::<String>()).unwrap();
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

#[test]
fn a_recording_too_short_for_a_label_fails_a_replay() {
    let folder = folder("short");
    let model = model(&folder);
    for (samples, labelled) in [(500, false), (660, false), (661, true), (1003, true)] {
        let recording = recording(&folder, samples);
        let [model, recording] = [&model, &recording].map(|path| path.to_str().unwrap());
        assert_eq!(
            myointent(&["replay", model, recording]),
            labelled,
            "{samples}"
        );
    }
}

#[test]
fn a_folder_without_one_readable_recording_fails_inspect_and_evaluate() {
    let folder = folder("damaged");
    let model = model(&folder);
    let path = recording(&folder, 700);
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace(",-", ",x")).unwrap();
    let [model, page] = [model, folder.join("page.html")].map(|path| path.display().to_string());
    let own = path.parent().unwrap().to_str().unwrap();
    assert!(!myointent(&["data", "inspect", own]));
    let evaluate = [
        "evaluate", "--model", &model, "--data", own, "--report", &page,
    ];
    assert!(!myointent(&evaluate));
}

#[test]
fn several_paths_are_taken_as_one_folder_that_holds_them() {
    let folder = folder("several");
    let model = model(&folder);
    let (data, _) = small::recordings(&folder);
    let file = |person: &str| data.join(person).join(format!("{person}_synthetic_1.csv"));
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let whole = [text(&data)];
    // Folders, files, and one of both again.
    let parts = [
        data.join("s1"),
        file("s2"),
        data.join("s3"),
        file("s4"),
        file("s1"),
    ];
    let parts = parts.map(|path| text(&path));
    let [model, one, several] =
        [&model, &folder.join("one"), &folder.join("several")].map(|path| text(path));
    let with = |line: &[&str], paths: &[String]| {
        let paths = paths.iter().map(String::as_str);
        let line: Vec<&str> = line.iter().copied().chain(paths).collect();
        myointent(&line)
    };
    let table = |name: &str, paths: &[String]| {
        let [csv, page] =
            ["csv", "html"].map(|ending| text(&folder.join(format!("{name}.{ending}"))));
        let line = [
            "evaluate", "--model", &model, "--csv", &csv, "--report", &page, "--data",
        ];
        assert!(with(&line, paths));
        fs::read_to_string(&csv).unwrap()
    };
    let expected = table("one", &whole);
    // The model and two floors for each of four people.
    assert_eq!(expected.lines().count(), 13, "{expected}");
    assert_eq!(table("several", &parts), expected);
    for (out, paths) in [(&one, &whole[..]), (&several, &parts)] {
        let line = ["predict", "--model", &model, "--out", out, "--recording"];
        assert!(with(&line, paths));
        assert!(with(&["score", "--prediction", out, "--truth"], paths));
    }
    let library = load(&data, &LoadOptions::default()).unwrap();
    let labels = |out: &str, own: &Recording| Path::new(out).join(own.full_name() + ".csv");
    for own in &library.recordings {
        let [a, b] = [&one, &several].map(|out| fs::read(labels(out, own)).unwrap());
        assert_eq!(a, b);
    }
    let out = text(&folder.join("labels.csv"));
    let line = ["predict", "--model", &model, "--out", &out, "--recording"];
    assert!(!with(&line, &parts), "one file for the labels of four");
    let prediction = text(&labels(&one, &library.recordings[0]));
    let line = ["score", "--prediction", &prediction, "--truth"];
    assert!(!with(&line, &parts), "labels of one for four");
    // Another person of the same name.
    let other = folder.join("other/s2/s2_synthetic_1.csv");
    fs::create_dir_all(other.parent().unwrap()).unwrap();
    fs::copy(file("s3"), &other).unwrap();
    let line = ["predict", "--model", &model, "--out", &one, "--recording"];
    assert!(!with(&line, &[text(&file("s2")), text(&other)]));
}
