//! Numbers of `score`, and the columns and files that they come from.

use clap::Parser as _;

use super::*;
use crate::cli::{Cli, Command};

#[test]
fn a_failed_transition_is_shown_with_its_reason() {
    let (r, o) = (Some(Intent::Relax), Some(Intent::Open));
    let truth = [vec![r; 300], vec![o; 300], vec![r; 300]].concat();
    let prediction = [vec![r; 310], vec![o; 540], vec![None; 50]].concat();
    let truth = GroundTruth {
        labels: truth,
        ..GroundTruth::default()
    };
    let score = LabelScore::new(&truth, &prediction, Emission::After(0), Rule::default());
    let score = score.unwrap();
    let text = score.tables();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "balanced accuracy 0.756",
        "transition accuracy 0.500 (1 of 2)",
        "when emitted balanced 0.756, transition 0.500",
        "so soon 1.000 in 100 ms, 1.000 in 150 ms",
        "gestures recognised 1.000 (1 of 1)",
        "latency half within 50 ms, nine in ten within 50 ms of the onset",
        // The last 50 samples have no prediction: they are not rest either.
        "false activations 0.0 a minute (0 in 2.2 s) of rest",
        "one decision 1.000; rest kept 0.500 (open 1 of 1, relax 1 of 2)",
        "300 1.50 open recognised open +50 +1250",
        "release half within 1250 ms, nine in ten within 1250 ms of the end",
        "mean +50 ms",
        "the last 50 samples",
        "1 x no_change_in_buffer: no change from the old label to the new one",
        "relax 300 250 0 0",
    ] {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
    let report = score.json();
    assert_eq!(report["changes"][1]["status"], "no_change_in_buffer");
    assert_eq!(report["offset_ms"]["signed"]["mean"], 50.0);
}

/// Scores of these files as the program prints them.
fn scored(truth: &Path, prediction: &Path, more: &[&str]) -> String {
    let [truth, prediction] = [truth, prediction].map(|path| path.to_str().unwrap());
    let line = ["myointent", "score", "--truth", truth, "--prediction"];
    let line = line.iter().chain([&prediction]);
    let Command::Score(arguments) = Cli::parse_from(line.chain(more)).command else {
        panic!("the command is score");
    };
    report(&arguments).unwrap()
}

fn json(truth: &Path, prediction: &Path, more: &[&str]) -> serde_json::Value {
    let report = scored(truth, prediction, &[&["--json"], more].concat());
    serde_json::from_str(&report).unwrap()
}

#[test]
fn a_csv_with_both_columns_is_scored_against_its_truth_and_not_against_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("labels.csv");
    let rows = "relax,relax\n".repeat(30) + &"close,relax\n".repeat(10);
    std::fs::write(&path, format!("gt,prediction\n{rows}")).unwrap();
    assert_eq!(json(&path, &path, &[])["raw_accuracy"], 0.75);
}

#[test]
fn other_movement_is_counted_apart_and_is_no_prediction() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, prediction] = ["truth.txt", "prediction.txt"].map(|name| folder.path().join(name));
    let rows = |runs: [&str; 4]| runs.map(|label| format!("{label}\n").repeat(100)).concat();
    std::fs::write(&truth, rows(["relax", "point", "-2", "relax"])).unwrap();
    std::fs::write(&prediction, rows(["relax", "open", "relax", "relax"])).unwrap();
    let text = scored(&truth, &prediction, &[]);
    let expected = "other movements      1 of 2 raise a label; 60.0 a minute (1 in 1.0 s)\n";
    assert!(text.contains(expected), "{text}");
    std::fs::write(&prediction, rows(["relax", "other", "relax", "relax"])).unwrap();
    let report = json(&truth, &prediction, &[]);
    assert_eq!(report["other_movements"]["point"]["counted"], 0);
    assert_eq!(
        report["confusion"]["intents"],
        serde_json::json!(["relax", "open", "close"])
    );
}

#[test]
fn the_column_of_emitted_labels_is_scored_by_itself_unless_a_delay_is_given() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("labels.csv");
    let row = |truth, label, emitted| format!("{truth},{label},{emitted}\n");
    let rows = row("relax", "relax", "none").repeat(10)
        + &row("relax", "relax", "relax").repeat(290)
        + &row("close", "close", "relax").repeat(20)
        + &row("close", "close", "close").repeat(280);
    std::fs::write(&path, format!("gt,prediction,emitted\n{rows}")).unwrap();
    for (delay, latency, relax, soon) in [
        (&[][..], 20, 290.0, 1.0),
        (&["--delay", "51"], 51, 249.0, 0.0),
    ] {
        let report = json(&path, &path, delay);
        assert_eq!(report["balanced_accuracy"], 1.0);
        assert_eq!(report["gestures"][0]["latency"], latency);
        let late = report["at_emission"]["balanced_accuracy"].as_f64().unwrap();
        let right = f64::from(300 - latency);
        assert!((late - (right + relax) / 600.0).abs() < 1e-9, "{late}");
        assert_eq!(report["recognised_within_ms"]["200"], soon);
    }
}
