//! Files of a run that belong together, and files that a command never replaces.

use std::fs;
use std::io::BufRead as _;
use std::path::Path;

use burn::tensor::Device;
use execution::run_folder::RunFolder;
use shared::model::file::Model;
use training::run::context::RunContext;

use super::{Bench, fails, succeeds};
use crate::small::{myointent, paths};

fn figures(file: &Path) -> Vec<(String, f32)> {
    let bytes = fs::read(file).unwrap();
    let model = Model::parse(&bytes).unwrap();
    let metrics = model.header.provenance.metrics;
    metrics
        .iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

fn weights(run: &Path) -> Vec<u8> {
    assert!(myointent(&format!("export --run {}", run.display())));
    fs::read(run.join("teacher.safetensors")).unwrap()
}

#[test]
fn a_student_of_another_split_is_neither_evaluated_nor_quantized() {
    let bench = Bench::new("other-split");
    let fold = "--protocol 2-fold --fold";
    succeeds(&bench.begin("train", "run", &format!("{fold} 1")));
    succeeds(&bench.on("quantize", "run", ""));
    let second = format!("{fold} 2 --overwrite --teacher-only");
    succeeds(&bench.begin("train", "run", &second));
    fails(
        &bench.on("evaluate", "run", ""),
        "student.bpk does not belong",
    );
    fails(
        &bench.on("quantize", "run", ""),
        "student.bpk does not belong",
    );
    succeeds(&bench.on("train", "run", "--resume"));
    // The model file is still the first student's.
    fails(
        &bench.on("evaluate", "run", ""),
        "student.intent is not the model file",
    );
    succeeds(&bench.on("quantize", "run", ""));
    succeeds(&bench.on("evaluate", "run", ""));
}

#[test]
fn resume_does_not_take_the_weights_of_the_run_before() {
    let bench = Bench::new("fresh");
    succeeds(&bench.begin("train", "run", ""));
    // A fresh start that is stopped in its first epoch.
    let (config, library) = bench.configuration(7);
    let folder = RunFolder::open(bench.path("run")).unwrap();
    drop(RunContext::begin(folder, config, library, Device::default().autodiff()).unwrap());
    succeeds(&bench.on("train", "run", "--resume"));
    succeeds(&bench.begin("train", "honest", "--seed 7"));
    let same = weights(&bench.path("run")) == weights(&bench.path("honest"));
    assert!(same, "the resumed run has other weights");
}

#[test]
fn resume_is_refused_with_another_configuration() {
    let bench = Bench::new("resume");
    for command in ["train", "quickstart"] {
        succeeds(&bench.begin(command, command, "--seed 7"));
        succeeds(&bench.begin(command, command, "--seed 7 --resume"));
        fails(
            &bench.begin(command, command, "--seed 8 --resume"),
            "(seed 7 / 8)",
        );
    }
    // An interrupted command advises the same command with --resume.
    for resume in ["", "--resume"] {
        let fold = format!("--protocol 2-fold --fold 1 {resume}");
        succeeds(&bench.begin("train", "fold", &fold));
    }
}

#[test]
fn a_run_is_not_replaced_by_a_second_one() {
    let bench = Bench::new("second");
    for command in ["train", "quickstart"] {
        succeeds(&bench.begin(command, command, ""));
        let content = |name: &str| fs::read(bench.path(command).join(name)).unwrap();
        let before = content("config.json");
        // The same command, and one of another run.
        for more in ["", "--seed 7"] {
            fails(&bench.begin(command, command, more), "--overwrite");
        }
        assert!(content("config.json") == before, "{command}");
        succeeds(&bench.begin(command, command, "--seed 7 --overwrite"));
        assert!(content("config.json") != before, "{command}");
    }
    // Files that another command has written into the same folder are not replaced.
    let foreign = bench.path("foreign");
    fs::create_dir(&foreign).unwrap();
    fs::write(foreign.join("student.intent"), "somebody's").unwrap();
    fails(&bench.begin("quickstart", "foreign", ""), "student.intent");
    assert_eq!(
        fs::read(foreign.join("student.intent")).unwrap(),
        b"somebody's"
    );
}

#[test]
fn a_model_and_a_recording_are_never_replaced_by_what_a_command_writes() {
    let bench = Bench::new("outputs");
    fs::copy(
        myointent_tests::shipped("three-class"),
        bench.path("mine.intent"),
    )
    .unwrap();
    let (model, recording) = ("mine.intent", "data/s1/s1_synthetic_1.csv");
    let before = [model, recording].map(|name| fs::read(bench.path(name)).unwrap());

    let shipped = myointent_tests::shipped("three-class");
    let gate = format!("gate {} --other 1 --out @mine.intent", shipped.display());
    fails(&paths(&bench.folder, &gate), "exists already");
    let predict = |out| {
        let line = format!("predict --model @mine.intent --recording @{recording} --out @{out}");
        paths(&bench.folder, &line)
    };
    fails(&predict(recording), "exists already");
    let report = |out| {
        let line = format!("report @mine.intent --data @data --out @{out}");
        paths(&bench.folder, &line)
    };
    fails(&report(recording), "exists already");
    let after = [model, recording].map(|name| fs::read(bench.path(name)).unwrap());
    assert!(before == after);

    // An earlier output of the same kind is replaced.
    for _ in 0..2 {
        succeeds(&predict("labels.csv"));
        succeeds(&report("page.html"));
    }
    fails(&predict("page.html"), "expected a name that ends in");
    fails(&report("labels.csv"), "no earlier output");
}

#[test]
fn figures_of_another_model_are_not_written_into_the_runs_own() {
    let bench = Bench::new("figures");
    succeeds(&bench.begin("quickstart", "other", "--seed 7"));
    succeeds(&bench.begin("quickstart", "run", ""));
    let (own, other) = (
        bench.path("run/student.intent"),
        bench.path("other/student.intent"),
    );
    let honest = figures(&own);
    assert_ne!(
        honest,
        figures(&other),
        "the test needs two models that differ"
    );
    succeeds(&bench.on("evaluate", "run", "--model @other/student.intent"));
    succeeds(&bench.on("quantize", "run", ""));
    assert_eq!(figures(&own), honest);
}

#[test]
fn a_preset_without_a_teacher_trains_one_if_asked() {
    let bench = Bench::new("extra");
    bench.edit(&[("teacher_share = 0.5", "teacher_share = 0.0")]);
    let begin = |run, more| succeeds(&bench.begin_with("train", "@edited.toml", run, more));
    let has = |run: &str, name: &str| bench.path(run).join(name).exists();
    begin("student", "");
    assert!(!has("student", "teacher.bpk") && has("student", "student.bpk"));
    begin("both", "--teacher");
    assert!(has("both", "teacher.bpk") && has("both", "student.bpk"));
    begin("teacher", "--teacher-only");
    assert!(has("teacher", "teacher.bpk") && !has("teacher", "student.bpk"));
    succeeds(&bench.on("train", "teacher", "--resume"));
    assert!(has("teacher", "student.bpk"));
}

#[test]
fn an_ensemble_goes_on_where_it_was_interrupted() {
    let bench = Bench::new("ensemble");
    bench.edit(&[(
        "temperature = 2.0",
        "temperature = 2.0\nensemble = { members = 2, epochs = 2 }",
    )]);
    succeeds(&bench.begin_with("quickstart", "@edited.toml", "run", ""));
    let run = bench.path("run");
    let content = |name: &str| fs::read(run.join(name)).unwrap();
    assert!(!run.join("teacher.bpk").exists());
    assert_ne!(content("member-1.bpk"), content("member-2.bpk"));
    assert_eq!(content("member-1.jsonl").as_slice().lines().count(), 2);
    assert_eq!(content("student.jsonl").as_slice().lines().count(), 1);
    let whole = content("student.intent");
    for name in ["member-2", "student"] {
        for ending in ["bpk", "checkpoint", "jsonl"] {
            fs::remove_file(run.join(format!("{name}.{ending}"))).unwrap();
        }
    }
    succeeds(&bench.on("train", "run", "--resume"));
    succeeds(&bench.on("quantize", "run", ""));
    assert!(content("student.intent") == whole);
}
