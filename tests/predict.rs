//! Commands `predict` and then `score`, as the README and the guide show them, on recordings of any length; and what
//! another program computes from an exported student.

#[path = "predict/onnx.rs"]
mod onnx;
#[path = "small.rs"]
mod small;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use myointent_tests::small_model;
use recordings::{LoadOptions, Recording, load};
use shared::intent::Vocabulary;
use small::{folder, myointent};

/// Makes a folder of a test, with a small model.
fn with_model(test: &str) -> (PathBuf, PathBuf) {
    let folder = folder(test);
    let model = folder.join("three-class.intent");
    small_model(&model, &[], Vocabulary::Three);
    (folder, model)
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
    let (folder, model) = with_model("predict");
    let labels = folder.join("labels.csv");
    for samples in [9, 1003, 1009, 1010, 9001] {
        let recording = recording(&folder, samples);
        let [model, recording, out] = [&model, &recording, &labels].map(|path| path.display());
        let _ = fs::remove_file(&labels);
        let predict = format!("predict --model {model} --recording {recording} --out {out}");
        assert!(myointent(&predict));
        let rows = fs::read_to_string(&labels).unwrap();
        assert_eq!(rows.lines().count(), 1 + samples);
        let score = format!("score --truth {recording} --prediction {out} --delay 51");
        assert!(myointent(&score), "{samples}");
    }
}

#[test]
fn a_recording_too_short_for_a_label_fails_a_replay() {
    let (folder, model) = with_model("short");
    for (samples, labelled) in [(500, false), (660, false), (661, true), (1003, true)] {
        let recording = recording(&folder, samples);
        let line = format!("replay {} {}", model.display(), recording.display());
        assert_eq!(myointent(&line), labelled, "{samples}");
    }
}

#[test]
fn a_folder_without_one_readable_recording_fails_inspect_and_evaluate() {
    let (folder, model) = with_model("damaged");
    let path = recording(&folder, 700);
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace(",-", ",x")).unwrap();
    let page = folder.join("page.html");
    let [model, own, page] = [&*model, path.parent().unwrap(), &*page].map(Path::display);
    assert!(!myointent(&format!("data inspect {own}")));
    let evaluate = format!("evaluate --model {model} --data {own} --report {page}");
    assert!(!myointent(&evaluate));
}

#[test]
fn several_paths_are_taken_as_one_folder_that_holds_them() {
    let (folder, model) = with_model("several");
    let (data, _) = small::recordings(&folder);
    let file = |person: &str| data.join(person).join(format!("{person}_synthetic_1.csv"));
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let whole = text(&data);
    // Folders, files, and one of both again.
    let (s1, s3) = (data.join("s1"), data.join("s3"));
    let parts = [s1, file("s2"), s3, file("s4"), file("s1")].map(|path| text(&path));
    let parts = parts.join(" ");
    let [model, one, several] =
        [&model, &folder.join("one"), &folder.join("several")].map(|path| text(path));
    let table = |name: &str, paths: &str| {
        let [csv, page] =
            ["csv", "html"].map(|ending| text(&folder.join(format!("{name}.{ending}"))));
        let line = format!("evaluate --model {model} --csv {csv} --report {page} --data {paths}");
        assert!(myointent(&line));
        fs::read_to_string(&csv).unwrap()
    };
    let predict = |out: &str, paths: &str| {
        myointent(&format!(
            "predict --model {model} --out {out} --recording {paths}"
        ))
    };
    let score = |prediction: &str, paths: &str| {
        myointent(&format!("score --prediction {prediction} --truth {paths}"))
    };
    let expected = table("one", &whole);
    // The model and two floors for each of four people.
    assert_eq!(expected.lines().count(), 13, "{expected}");
    assert_eq!(table("several", &parts), expected);
    for (out, paths) in [(&one, &whole), (&several, &parts)] {
        assert!(predict(out, paths) && score(out, paths));
    }
    let library = load(&data, &LoadOptions::default()).unwrap();
    let labels = |out: &str, own: &Recording| Path::new(out).join(own.full_name() + ".csv");
    for own in &library.recordings {
        let [a, b] = [&one, &several].map(|out| fs::read(labels(out, own)).unwrap());
        assert_eq!(a, b);
    }
    let out = text(&folder.join("labels.csv"));
    assert!(!predict(&out, &parts), "one file for the labels of four");
    let prediction = text(&labels(&one, &library.recordings[0]));
    assert!(!score(&prediction, &parts), "labels of one for four");
    // Another person of the same name.
    let other = folder.join("other/s2/s2_synthetic_1.csv");
    fs::create_dir_all(other.parent().unwrap()).unwrap();
    fs::copy(file("s3"), &other).unwrap();
    let two = [text(&file("s2")), text(&other)].join(" ");
    assert!(!predict(&one, &two));
}
