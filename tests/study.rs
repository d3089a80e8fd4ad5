//! Protocols, fine-tuning and the study, small, through the command line itself.

#[path = "small.rs"]
mod small;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use small::{folder, myointent, recordings, small_preset};

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
fn a_study_leaves_everybody_out_once_and_its_jobs_stand_for_themselves() {
    let folder = folder("study");
    let (data, _) = recordings(&folder);
    let (preset, study) = (small_preset(&folder), folder.join("study"));
    let [data, preset, path] = [&data, &preset, &study].map(|path| path.to_str().unwrap());
    let job = |fold: &str| {
        let line = ["study", "--preset", preset, "--data", data, "--study", path];
        let which = [
            "--protocol",
            "2-fold",
            "--variant",
            "main,window-100",
            "--fold",
            fold,
        ];
        myointent(&[&line[..], &which[..]].concat())
    };
    // The second fold needs nothing of the first.
    assert!(job("2") && job("1"));

    let mut left_out = Vec::new();
    for fold in ["fold-1", "fold-2"] {
        let run = study.join("main").join(fold);
        let split = &json(&run.join("plan.json"))["split"];
        let held_out = names(&split["held_out"]);
        let others: BTreeSet<_> = ["training", "validation"]
            .iter()
            .flat_map(|role| names(&split[role]))
            .collect();
        assert!(held_out.iter().all(|subject| !others.contains(subject)));
        let judged = &json(&run.join("results.json"))["published"];
        let models: BTreeSet<&str> = judged
            .as_array()
            .unwrap()
            .iter()
            .map(|line| line["model"].as_str().unwrap())
            .collect();
        for model in ["teacher", "integer student", "student without teacher"] {
            assert!(models.contains(model), "{model} is not among {models:?}");
        }
        left_out.extend(held_out);
    }
    left_out.sort_unstable();
    let everybody: BTreeSet<_> = left_out.iter().cloned().collect();
    assert_eq!((left_out.len(), everybody.len()), (4, 4));

    let short = study.join("window-100/fold-1");
    assert_eq!(
        json(&short.join("plan.json"))["preset"]["teacher"]["window"],
        100
    );
    assert!(short.join("results.json").exists() && !short.join("student.bpk").exists());
    // What is done is not done again.
    let before = fs::metadata(study.join("main/fold-1/results.json"))
        .unwrap()
        .modified()
        .unwrap();
    assert!(job("1"));
    let after = fs::metadata(study.join("main/fold-1/results.json"))
        .unwrap()
        .modified()
        .unwrap();
    assert_eq!(before, after);
    assert!(!job("3"), "there is no third fold");

    // All of them together are judged as one.
    let main = study.join("main");
    assert!(myointent(&["summary", main.to_str().unwrap()]));
    let all = &json(&main.join("summary.json"))["results"]["published"][0]["emitted"];
    let judged: Vec<&str> = all["subjects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|score| score["subject"].as_str().unwrap())
        .collect();
    assert_eq!(judged, left_out);
    let tables = folder.join("tables");
    let write = || myointent(&["tables", path, "--out", tables.to_str().unwrap()]);
    assert!(write());
    let page = |name: &str| fs::read_to_string(tables.join(name)).unwrap();
    assert!(page("tables.md").contains("2 of 2 folds"));
    let window = page("window-moved.csv");
    assert!(window.contains("\n100,0,") && window.contains("\n600,0,"));

    // A fold that is not there is told; one that is not judged is refused.
    fs::rename(main.join("fold-2"), folder.join("elsewhere")).unwrap();
    assert!(write() && page("tables.md").contains("1 of 2 folds"));
    fs::remove_file(main.join("fold-1/results.json")).unwrap();
    assert!(!write());
}

#[test]
fn a_teacher_is_trained_on_from_a_run_or_from_safetensors() {
    let folder = folder("fine-tuning");
    let (data, _) = recordings(&folder);
    let preset = small_preset(&folder);
    let run = |name: &str| folder.join(name);
    let first = run("first");
    let [data, preset, start] = [&data, &preset, &first].map(|path| path.to_str().unwrap());
    let train = |name: &str, fold: &str, more: &[&str]| {
        let path = run(name);
        let line = [
            "train",
            "--preset",
            preset,
            "--data",
            data,
            "--run",
            path.to_str().unwrap(),
        ];
        let turn = ["--protocol", "2-fold", "--fold", fold];
        myointent(&[&line[..], &turn[..], more].concat())
    };
    let teacher = |name: &str| {
        let path = run(name);
        assert!(myointent(&["export", "--run", path.to_str().unwrap()]));
        fs::read(path.join("teacher.safetensors")).unwrap()
    };
    assert!(train("first", "1", &[]));
    assert!(train("tuned", "1", &["--from", start]));
    assert!(train("adapted", "1", &["--from", start, "--lora"]));
    assert!(teacher("tuned") != teacher("first"));
    assert!(teacher("adapted") != teacher("first"));

    // Those whom the other fold leaves out have been trained on by this one.
    assert!(!train("leak", "2", &["--from", start]));
    assert!(!run("leak").exists());

    let checkpoint = first.join("teacher.safetensors");
    assert!(train(
        "imported",
        "1",
        &["--from", checkpoint.to_str().unwrap()]
    ));
    assert!(
        teacher("imported") == teacher("tuned"),
        "the same start, told in two ways"
    );
}
