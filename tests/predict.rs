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
use small::{folder, in_folder};

/// Makes a folder of a test, with a small model.
fn with_model(test: &str) -> PathBuf {
    let folder = folder(test);
    small_model(&folder.join("small.intent"), &[], Vocabulary::Three);
    folder
}

/// Writes a recording of `samples` samples, with labels, as the csv `anna/anna_SAMPLES.csv`.
fn recording(folder: &Path, samples: usize) {
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
    fs::write(own.join(format!("anna_{samples}.csv")), text).unwrap();
}

#[test]
fn predict_and_then_score_take_a_recording_of_any_length() {
    let folder = with_model("predict");
    let labels = folder.join("labels.csv");
    for samples in [9, 1003, 1009, 1010, 9001] {
        recording(&folder, samples);
        let _ = fs::remove_file(&labels);
        let own = format!("@anna/anna_{samples}.csv");
        let predict = format!("predict --model @small.intent --recording {own} --out @labels.csv");
        assert!(in_folder(&folder, &predict));
        let rows = fs::read_to_string(&labels).unwrap();
        assert_eq!(rows.lines().count(), 1 + samples);
        let score = format!("score --truth {own} --prediction @labels.csv --delay 51");
        assert!(in_folder(&folder, &score), "{samples}");
    }
}

#[test]
fn a_recording_too_short_for_a_label_fails_a_replay() {
    let folder = with_model("short");
    for (samples, labelled) in [(500, false), (660, false), (661, true), (1003, true)] {
        recording(&folder, samples);
        let line = format!("replay @small.intent @anna/anna_{samples}.csv");
        assert_eq!(in_folder(&folder, &line), labelled, "{samples}");
    }
}

#[test]
fn a_folder_without_one_readable_recording_fails_inspect_and_evaluate() {
    let folder = with_model("damaged");
    recording(&folder, 700);
    let path = folder.join("anna/anna_700.csv");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace(",-", ",x")).unwrap();
    assert!(!in_folder(&folder, "data inspect @anna"));
    let evaluate = "evaluate --model @small.intent --data @anna --report @page.html";
    assert!(!in_folder(&folder, evaluate));
}

#[test]
fn several_paths_are_taken_as_one_folder_that_holds_them() {
    let folder = with_model("several");
    let data = small::recordings(&folder);
    // Folders, files, and one of both again.
    let parts = "@data/s1 @data/s2/s2_synthetic_1.csv @data/s3 @data/s4/s4_synthetic_1.csv @data/s1/s1_synthetic_1.csv";
    let table = |name: &str, paths: &str| {
        let line = format!("--csv @{name}.csv --report @{name}.html --data {paths}");
        assert!(in_folder(
            &folder,
            &format!("evaluate --model @small.intent {line}")
        ));
        fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap()
    };
    let predict = |out: &str, paths: &str| {
        let line = format!("predict --model @small.intent --out @{out} --recording {paths}");
        in_folder(&folder, &line)
    };
    let score = |prediction: &str, paths: &str| {
        let line = format!("score --prediction @{prediction} --truth {paths}");
        in_folder(&folder, &line)
    };
    let expected = table("one", "@data");
    // The model and two floors for each of four people.
    assert_eq!(expected.lines().count(), 13, "{expected}");
    assert_eq!(table("several", parts), expected);
    for (out, paths) in [("one", "@data"), ("several", parts)] {
        assert!(predict(out, paths) && score(out, paths));
    }
    let library = load(&data, &LoadOptions::default()).unwrap();
    let labels = |out: &str, own: &Recording| format!("{out}/{}.csv", own.full_name());
    for own in &library.recordings {
        let [a, b] = ["one", "several"].map(|out| fs::read(folder.join(labels(out, own))).unwrap());
        assert_eq!(a, b);
    }
    assert!(
        !predict("labels.csv", parts),
        "one file for the labels of four"
    );
    let prediction = labels("one", &library.recordings[0]);
    assert!(!score(&prediction, parts), "labels of one for four");
    // Another person of the same name.
    let other = folder.join("other/s2/s2_synthetic_1.csv");
    fs::create_dir_all(other.parent().unwrap()).unwrap();
    fs::copy(data.join("s3/s3_synthetic_1.csv"), &other).unwrap();
    let two = "@data/s2/s2_synthetic_1.csv @other/s2/s2_synthetic_1.csv";
    assert!(!predict("one", two));
}
