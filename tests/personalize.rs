//! Model tuned on one person's recordings, through the command line itself.

#[path = "small.rs"]
mod small;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use evaluation::Measure;
use myointent_tests::shipped;
use recordings::synthetic::{self, SynthOptions};
use recordings::{LoadOptions, load};
use shared::model::file::Model;
use shared::units::CHANNELS;
use small::{folder, paths, run};
use training::run::personalize::{PersonRecordings, judge};

/// Exit code of a command that keeps the old model.
const KEPT: u8 = 3;

/// Tunes the shipped model on the `recordings` in a folder; `new.intent` is the new file there.
fn personalize(folder: &Path) -> ExitCode {
    let model = shipped("three-class").display().to_string();
    let line = "--data @recordings --out @new.intent";
    run(&paths(
        folder,
        &format!("personalize --model {model} {line}"),
    ))
}

/// Writes `recordings` of one synthetic person into a folder; returns them in the order in which they are read.
fn person(folder: &Path) -> Vec<PathBuf> {
    let options = SynthOptions {
        subjects: 1,
        recordings: 3,
        seconds: 60,
        ..SynthOptions::default()
    };
    synthetic::write(&options, &folder.join("recordings")).unwrap()
}

fn seen(file: &Path) -> Vec<String> {
    let bytes = fs::read(file).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let seen = model.header.provenance.subjects_seen.iter();
    seen.map(str::to_owned).collect()
}

/// Changes each line of a recording: the label, eight channels, and what follows.
fn rewrite(path: &Path, change: impl Fn(&mut [&str])) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let mut rewritten = vec![lines.next().unwrap().to_owned()];
    for line in lines {
        let mut fields: Vec<&str> = line.split(',').collect();
        change(&mut fields);
        rewritten.push(fields.join(","));
    }
    fs::write(path, rewritten.join("\n")).unwrap();
}

/// Turns the armband by three places: gestures are then unlike those of most training people.
fn turn(path: &Path) {
    rewrite(path, |fields| fields[1..=CHANNELS].rotate_left(3));
}

/// Exchanges the labels of two classes.
fn exchange(path: &Path, [one, other]: [&'static str; 2]) {
    rewrite(path, |fields| {
        if fields[0] == one {
            fields[0] = other;
        } else if fields[0] == other {
            fields[0] = one;
        }
    });
}

/// Returns the balanced accuracy of a model on the part of a person's recordings that `personalize` holds back.
fn on_the_part_held_back(model: &Path, recordings: &Path) -> f64 {
    let bytes = fs::read(model).unwrap();
    let header = Model::parse(&bytes).unwrap().header;
    let library = load(recordings, &LoadOptions::default()).unwrap();
    let person = PersonRecordings::new(&library, None, &header).unwrap();
    let (_, held_back) = person.whole().divided().unwrap();
    let score = judge("model", &bytes, &held_back).unwrap();
    Measure::BalancedAccuracy.mean(&score).unwrap().mean
}

#[test]
fn who_is_unlike_the_people_of_the_training_gets_a_better_model() {
    let folder = folder("personalize");
    person(&folder).iter().for_each(|path| turn(path));
    let [recordings, out] = ["recordings", "new.intent"].map(|name| folder.join(name));
    assert_eq!(personalize(&folder), ExitCode::SUCCESS);
    let [before, after] =
        [&shipped("three-class"), &out].map(|file| on_the_part_held_back(file, &recordings));
    assert!(after > before + 0.02, "{before} {after}");
    let mut expected = seen(&shipped("three-class"));
    expected.push("synthetic/s1".to_owned());
    assert_eq!(seen(&out), expected);

    // A file is not replaced, whatever its content.
    assert_eq!(personalize(&folder), ExitCode::FAILURE);
    assert_eq!(seen(&out), expected);
}

#[test]
fn the_old_model_is_kept_if_the_new_one_is_worse() {
    let folder = folder("personalize-worse");
    let files = person(&folder);
    // The labels that it is tuned on contradict those held back, of the last recording.
    let [first, second] = [&files[0], &files[1]];
    for path in [first, second] {
        exchange(path, ["1", "2"]);
    }
    assert_eq!(personalize(&folder), ExitCode::from(KEPT));
    let names = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    assert_eq!(
        names.collect::<Vec<_>>(),
        ["recordings"],
        "nothing was written"
    );
}

#[test]
fn exchanged_labels_are_not_tuned_on() {
    let folder = folder("personalize-exchanged");
    let files = person(&folder);
    files.iter().for_each(|path| exchange(path, ["1", "2"]));
    assert_eq!(personalize(&folder), ExitCode::from(KEPT));
    assert!(!folder.join("new.intent").exists());
}
