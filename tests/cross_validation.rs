//! Cross-validations and fine-tuning, small, through the command lines of `myointent-research` and
//! `myointent`.

#[path = "small.rs"]
mod small;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use clap::Parser as _;
use myointent_research::cli::Cli;
use recordings::npy;
use recordings::synthetic::{self, SynthOptions};
use serde_json::Value;
use shared::intent::Intent;
use small::{folder, in_folder, paths, recordings, small_preset};

/// Runs a cross-validation of `myointent-research` with folds of a protocol, of the small preset and the recordings in a folder,
/// into `out` there; returns true if it succeeds.
fn cross_validate(folder: &Path, rest: &str) -> bool {
    let start = "myointent-research cross-validate --preset @small.toml --data @data --out @out";
    let line = paths(folder, &format!("{start} --protocol {rest}"));
    let words = line.split_whitespace();
    Cli::try_parse_from(words).unwrap().run() == ExitCode::SUCCESS
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

fn names(value: &Value) -> Vec<String> {
    let names = value.as_array().unwrap().iter();
    names
        .map(|name| name.as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn a_teacher_is_fine_tuned_from_a_run_or_from_safetensors() {
    let folder = folder("fine-tuning");
    recordings(&folder);
    small_preset(&folder);
    let train = |name: &str, rest: &str| {
        let line = format!("train --preset @small.toml --data @data --run @{name}");
        in_folder(&folder, &format!("{line} --protocol 2-fold --fold {rest}"))
    };
    let teacher = |name: &str| {
        assert!(in_folder(&folder, &format!("export --run @{name}")));
        fs::read(folder.join(name).join("teacher.safetensors")).unwrap()
    };
    assert!(train("first", "1"));
    assert!(train("tuned", "1 --from @first"));
    assert!(train("adapted", "1 --from @first --lora"));
    assert!(teacher("tuned") != teacher("first"));
    assert!(teacher("adapted") != teacher("first"));

    // The start comes from fold 1, which has trained on subjects that fold 2 holds out.
    assert!(!train("leak", "2 --from @first"));
    assert!(!folder.join("leak").exists());

    assert!(train("imported", "1 --from @first/teacher.safetensors"));
    assert!(
        teacher("imported") == teacher("tuned"),
        "one teacher from two kinds of files"
    );
}

#[test]
fn a_cross_validation_evaluates_everybody_once_for_each_seed_and_goes_on() {
    let folder = folder("cross-validation");
    recordings(&folder);
    let text = fs::read_to_string(small_preset(&folder)).unwrap();
    let text = text
        .replace("name = \"small\"", "name = \"other\"")
        .replace("teacher_share = 0.5", "teacher_share = 0.0");
    fs::write(folder.join("other.toml"), text).unwrap();
    let out = folder.join("out");
    let command = |rest: &str| {
        let compared = "2-fold --preset @other.toml --seeds 1,2 --baselines ed-tcn";
        cross_validate(&folder, &format!("{compared} {rest}"))
    };
    assert!(!command("--fold 3"));
    assert!(command("--fold 2"));
    assert!(
        !out.join("people.csv").exists(),
        "half of the jobs are left"
    );
    let student = |preset: &str| {
        let run = out.join(preset).join("seed-2").join("fold-2");
        (
            fs::read(run.join("student.intent")).unwrap(),
            run.join("teacher.bpk").exists(),
        )
    };
    let before = student("small");
    assert!(before.1, "a preset with a teacher trains one");
    assert!(!student("other").1, "labels alone need no teacher");
    assert!(command(""));
    assert_eq!(student("small"), before);

    let mut people = rows(&out, ["model", "seed", "subject"]);
    people.sort_unstable();
    // Four people, two seeds, two presets and a baseline with two aggregation modes, and two floors: each person in one fold of
    // each.
    assert_eq!(people.len(), 4 * 2 * (2 * 3 + 2));
    people.dedup();
    assert_eq!(people.len(), 4 * 2 * (2 + 3));
    let page = fs::read_to_string(out.join("tables.md")).unwrap();
    assert!(page.contains("other (0.25 s, all rows) - small (0.25 s, all rows)"));
    assert!(page.contains("ED-TCN (0.25 s, all rows) - small (0.25 s, all rows)"));
    assert!(page.contains("energy detector (0) - small (0.25 s, all rows)"));
    for seed in ["seed-1", "seed-2"] {
        let run = out.join("other").join(seed).join("fold-1");
        let split = &json(&run.join("config.json"))["split"];
        let held_out = names(&split["held_out"]);
        let others = [names(&split["training"]), names(&split["validation"])].concat();
        assert!(!held_out.is_empty() && held_out.iter().all(|subject| !others.contains(subject)));
    }
}

/// Fields of these columns in each row of `people.csv`.
fn rows<const N: usize>(out: &Path, columns: [&str; N]) -> Vec<[String; N]> {
    let mut reader = csv::Reader::from_path(out.join("people.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let at = columns.map(|name| header.iter().position(|own| own == name).expect(name));
    let records = reader.records().map(Result::unwrap);
    let fields = |record: csv::StringRecord| at.map(|at| record[at].to_owned());
    records.map(fields).collect()
}

/// Writes synthetic recordings of other people than those of [`recordings`] as files of roshambo, whose subject 06 is a
/// test person.
fn roshambo(folder: &Path, subjects: &[&str]) {
    let options = SynthOptions {
        subjects: subjects.len(),
        recordings: 1,
        seconds: 30,
        seed: 7,
        ..SynthOptions::default()
    };
    let data = folder.join("data");
    fs::create_dir_all(&data).unwrap();
    for (recording, subject) in synthetic::generate(&options).iter().zip(subjects) {
        let samples = recording
            .samples
            .iter()
            .flatten()
            .map(|value| value.cast_unsigned());
        let name = |label: &Option<Intent>| match label {
            Some(Intent::Open) => b"paper\0\0",
            Some(Intent::Close) => b"rock\0\0\0",
            _ => b"none\0\0\0",
        };
        let names = recording.labels.iter().flat_map(name).copied();
        let count = recording.labels.len();
        let write = |what: &str, bytes: Vec<u8>| {
            fs::write(
                data.join(format!("subject{subject}_session01_{what}.npy")),
                bytes,
            )
            .unwrap();
        };
        write(
            "emg",
            npy::encode("|i1", &[count, 8], &samples.collect::<Vec<_>>()),
        );
        write(
            "ann",
            npy::encode("|S7", &[count], &names.collect::<Vec<_>>()),
        );
    }
}

#[test]
fn a_cross_validation_scores_the_test_people_apart_by_students_that_never_saw_them() {
    let folder = folder("cross-validation-test-people");
    roshambo(&folder, &["01", "02", "03", "04", "06"]);
    small_preset(&folder);
    let out = folder.join("out");
    let command = |more: &str| cross_validate(&folder, &format!("2-fold --seeds 1 {more}"));
    let rows = || rows(&out, ["people", "subject", "classes", "fold"]);
    let student = || {
        let run = out.join("small/seed-1/fold-1");
        // Every epoch writes a checkpoint.
        let checkpoint = fs::metadata(run.join("student.checkpoint")).unwrap();
        let weights = fs::read(run.join("student.bpk")).unwrap();
        (checkpoint.modified().unwrap(), weights)
    };
    assert!(command(""));
    assert!(
        rows()
            .iter()
            .all(|row| row[0] == "development" && row[1] != "roshambo/06")
    );
    let page = fs::read_to_string(out.join("tables.md")).unwrap();
    assert!(!page.contains("Test people"));
    let trained = student();

    // Students are not trained again to score the test people.
    assert!(command("--test-people"));
    assert!(student() == trained);
    let all = rows();
    let (test, development): (Vec<_>, Vec<_>) = all.iter().partition(|row| row[0] == "test");
    // The four people count once; one test person is scored by the student of each of two folds. Each comes under two
    // modes and two floors.
    assert_eq!((development.len(), test.len()), (4 * 4, 2 * 4));
    assert!(test.iter().all(|row| row[1..3] == ["roshambo/06", "3"]));
    let folds: BTreeSet<&str> = test.iter().map(|row| &row[3][..]).collect();
    assert_eq!(folds.into_iter().collect::<Vec<_>>(), ["1", "2"]);
    let page = fs::read_to_string(out.join("tables.md")).unwrap();
    let (development, test) = page.split_once("Test people").unwrap();
    assert!(development.contains("small (0.25 s, all rows)"));
    assert!(test.contains("small (0.25 s, all rows)") && test.contains("energy detector"));
    for fold in ["fold-1", "fold-2"] {
        let split = &json(&out.join("small/seed-1").join(fold).join("config.json"))["split"];
        assert_eq!(names(&split["test"]), ["roshambo/06"]);
    }
    // Without the option the same folder has tables of development alone again.
    assert!(command(""));
    assert!(rows().iter().all(|row| row[0] == "development"));
}

#[test]
fn a_fold_of_sets_holds_out_everybody_of_one_set() {
    let folder = folder("cross-validation-sets");
    roshambo(&folder, &["01", "02", "06"]);
    recordings(&folder);
    let preset = small_preset(&folder);
    let text = fs::read_to_string(&preset).unwrap();
    let sets = "data_sets = [\"roshambo\", \"ss-stm\"]";
    assert!(text.contains(sets));
    fs::write(&preset, text.replace(sets, "data_sets = []")).unwrap();
    let out = folder.join("out");
    assert!(cross_validate(&folder, "sets --seeds 1"));
    for fold in ["fold-1", "fold-2"] {
        let split = &json(&out.join("small/seed-1").join(fold).join("config.json"))["split"];
        let held_out = names(&split["held_out"]);
        let seen = [names(&split["training"]), names(&split["validation"])].concat();
        let set = |person: &String| person.split('/').next().unwrap().to_owned();
        let out: BTreeSet<String> = held_out.iter().map(set).collect();
        assert_eq!(out.len(), 1, "{fold}");
        assert!(!seen.is_empty() && seen.iter().all(|person| !out.contains(&set(person))));
    }
    let page = fs::read_to_string(out.join("tables.md")).unwrap();
    assert!(page.contains("Each data set counts once") && page.contains("; n 2"));
}
