//! A model tuned on one person's recordings, through the command line itself.

#[path = "small.rs"]
#[expect(dead_code, reason = "nothing is trained from the start here")]
mod small;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser as _;
use myointent::cli::Cli;
use myointent::dataset::synthetic::{self, SynthOptions};
use myointent_tests::data;
use shared::model::file::Model;
use small::folder;

/// Exit code of a command that keeps the old model.
const KEPT: u8 = 3;

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/three-class.intent")
}

fn personalize(model: &Path, data: &Path, out: &Path, more: &[&str]) -> ExitCode {
    let [model, data, out] = [model, data, out].map(|path| path.to_str().unwrap());
    let mut line = vec![
        "myointent",
        "personalize",
        "--model",
        model,
        "--data",
        data,
        "--out",
        out,
    ];
    line.extend(more);
    Cli::try_parse_from(line).unwrap().run()
}

/// Recordings of one synthetic person in a folder of their own, in the order in which they are read.
fn person(folder: &Path) -> Vec<PathBuf> {
    let options = SynthOptions {
        subjects: 1,
        recordings: 3,
        seconds: 60,
        ..SynthOptions::default()
    };
    synthetic::write(&options, folder).unwrap()
}

fn seen(file: &Path) -> Vec<String> {
    let bytes = fs::read(file).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let seen = model.header.provenance.subjects_seen.iter();
    seen.map(str::to_owned).collect()
}

/// Takes open for close and close for open in a recording.
fn swap_gestures(path: &Path) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let mut swapped = vec![lines.next().unwrap().to_owned()];
    swapped.extend(lines.map(|line| match line.split_at(1) {
        ("1", rest) => format!("2{rest}"),
        ("2", rest) => format!("1{rest}"),
        _ => line.to_owned(),
    }));
    fs::write(path, swapped.join("\n")).unwrap();
}

#[test]
fn a_model_learns_a_person_and_the_old_one_is_kept_if_it_gets_worse() {
    let folder = folder("personalize");
    let recordings = folder.join("recordings");
    let files = person(&recordings);
    let first = folder.join("first.intent");
    assert_eq!(
        personalize(&shipped(), &recordings, &first, &[]),
        ExitCode::SUCCESS
    );
    let mut expected = seen(&shipped());
    expected.push("synthetic/s1".to_owned());
    assert_eq!(seen(&first), expected);

    // What is tuned on says the opposite of what is held back, the last recording.
    files[..2].iter().for_each(|path| swap_gestures(path));
    let second = folder.join("second.intent");
    assert_eq!(
        personalize(&first, &recordings, &second, &[]),
        ExitCode::from(KEPT)
    );
    let names = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    let mut names: Vec<_> = names.collect();
    names.sort_unstable();
    assert_eq!(names, ["first.intent", "recordings"], "nothing was written");

    // Nor is a file replaced, whatever it is.
    assert_eq!(
        personalize(&first, &recordings, &first, &[]),
        ExitCode::FAILURE
    );
    assert_eq!(seen(&first), expected);
}

#[test]
fn what_is_no_model_or_nobodys_recordings_is_refused() {
    let folder = folder("personalize-refused");
    let recordings = folder.join("recordings");
    let files = person(&recordings);
    let out = folder.join("new.intent");
    let refused = |model: &Path, data: &Path, more: &[&str]| {
        assert_eq!(personalize(model, data, &out, more), ExitCode::FAILURE);
        assert!(!out.exists());
    };
    refused(&files[0], &recordings, &[]);
    refused(&shipped(), &folder.join("nowhere"), &[]);
    refused(&shipped(), &recordings, &["--subject", "s2"]);
    let other_format = folder.join("other.intent");
    let mut bytes = fs::read(shipped()).unwrap();
    bytes[8] -= 1;
    fs::write(&other_format, bytes).unwrap();
    refused(&other_format, &recordings, &[]);
    let empty = folder.join("empty");
    fs::create_dir(&empty).unwrap();
    refused(&shipped(), &empty, &[]);
}

#[test]
fn real_recordings_are_tuned_on_and_the_file_says_so() {
    let Some(data) = data("real_recordings_are_tuned_on_and_the_file_says_so") else {
        return;
    };
    let folder = folder("personalize-real");
    let out = folder.join("new.intent");
    // A person of development whom the shipped model has not seen.
    let (data, person) = (data.join("wang-myo"), "wang-myo/S8");
    assert!(!seen(&shipped()).iter().any(|seen| seen == person));
    let code = personalize(&shipped(), &data, &out, &["--subject", "S8"]);
    if code == ExitCode::SUCCESS {
        assert_eq!(seen(&out).last().map(String::as_str), Some(person));
    } else {
        assert_eq!(code, ExitCode::from(KEPT));
        assert!(!out.exists());
    }
}
