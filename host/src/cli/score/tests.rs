//! Numbers of `score`, checked also against an implementation written from docs/metrics.md alone.

mod naive;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::*;

#[test]
fn a_failed_transition_is_shown_with_its_reason() {
    let (r, o) = (Some(Intent::Relax), Some(Intent::Open));
    let truth = [vec![r; 300], vec![o; 300], vec![r; 300]].concat();
    let prediction = [vec![r; 310], vec![o; 540], vec![None; 50]].concat();
    let truth = GroundTruth {
        labels: truth,
        ..GroundTruth::default()
    };
    let score = LabelScore::new("", &truth, &prediction, Emission::After(0), Rule::default());
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

#[test]
fn a_csv_with_both_columns_is_scored_against_its_truth_and_not_against_itself() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("labels.csv");
    let rows = "relax,relax\n".repeat(30) + &"close,relax\n".repeat(10);
    std::fs::write(&path, format!("gt,prediction\n{rows}")).unwrap();
    let arguments = Arguments {
        truth: vec![path.clone()],
        prediction: path,
        buffer: 200,
        strict: false,
        allow_relax: false,
        delay: None,
        label_lag: LabelLag::default(),
        as_recorded: false,
        json: true,
    };
    let report: serde_json::Value = serde_json::from_str(&report(&arguments).unwrap()).unwrap();
    assert_eq!(report["raw_accuracy"], 0.75);
}

#[test]
fn other_movement_is_counted_apart_and_is_no_prediction() {
    let folder = tempfile::tempdir().unwrap();
    let [truth, prediction] = ["truth.txt", "prediction.txt"].map(|name| folder.path().join(name));
    let rows = |runs: [&str; 4]| runs.map(|label| format!("{label}\n").repeat(100)).concat();
    std::fs::write(&truth, rows(["relax", "point", "-2", "relax"])).unwrap();
    std::fs::write(&prediction, rows(["relax", "open", "relax", "relax"])).unwrap();
    let mut arguments = Arguments {
        truth: vec![truth],
        prediction,
        buffer: 200,
        strict: false,
        allow_relax: false,
        delay: None,
        label_lag: LabelLag::default(),
        as_recorded: false,
        json: false,
    };
    let text = report(&arguments).unwrap();
    let expected = "other movements      1 of 2 raise a label; 60.0 a minute (1 in 1.0 s)\n";
    assert!(text.contains(expected), "{text}");
    std::fs::write(
        &arguments.prediction,
        rows(["relax", "other", "relax", "relax"]),
    )
    .unwrap();
    arguments.json = true;
    let report: serde_json::Value = serde_json::from_str(&report(&arguments).unwrap()).unwrap();
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
    for (delay, latency) in [(None, 20), (Some(51), 51)] {
        let arguments = Arguments {
            truth: vec![path.clone()],
            prediction: path.clone(),
            buffer: 200,
            strict: false,
            allow_relax: false,
            delay,
            label_lag: LabelLag::default(),
            as_recorded: false,
            json: true,
        };
        let report: serde_json::Value = serde_json::from_str(&report(&arguments).unwrap()).unwrap();
        assert_eq!(report["balanced_accuracy"], 1.0);
        assert_eq!(report["gestures"][0]["latency"], latency);
        let late = report["at_emission"]["balanced_accuracy"].as_f64().unwrap();
        let right = f64::from(300 - latency) / 300.0;
        let relax = if delay.is_none() { 290.0 } else { 249.0 } / 300.0;
        assert!((late - f64::midpoint(right, relax)).abs() < 1e-9, "{late}");
        let soon = report["recognised_within_ms"]["200"].as_f64();
        assert_eq!(soon, Some(if delay.is_none() { 1.0 } else { 0.0 }));
    }
}

/// Formats labels as the lines of a file.
fn lines(labels: &[Option<Intent>]) -> String {
    let name = |label: &Option<Intent>| label.map_or("none", Intent::name);
    labels
        .iter()
        .map(|label| name(label).to_owned() + "\n")
        .collect()
}

/// Random runs of labels, each at most `longest` samples; some are unlabelled.
fn random_labels(random: &mut ChaCha8Rng, samples: usize, longest: usize) -> Vec<Option<Intent>> {
    let mut labels = Vec::new();
    while labels.len() < samples {
        let label =
            Intent::from_class(random.random_range(0..4)).filter(|&own| own != Intent::WaveIn);
        labels.extend(vec![label; random.random_range(2..=longest)]);
    }
    labels.truncate(samples);
    labels
}

/// Copies the truth with a random shift, mistakes and gaps.
fn follower(random: &mut ChaCha8Rng, truth: &[Option<Intent>]) -> Vec<Option<Intent>> {
    let late = random.random_range(-60..120_i32);
    let at = |sample: usize| {
        usize::try_from(sample as i32 - late)
            .ok()
            .and_then(|at| truth.get(at))
    };
    let mut labels: Vec<_> = (0..truth.len())
        .map(|sample| at(sample).copied().flatten())
        .collect();
    for _ in 0..random.random_range(0..6) {
        let from = random.random_range(0..labels.len());
        let to = (from + random.random_range(1..150)).min(labels.len());
        labels[from..to].fill(random_labels(random, 1, 2)[0]);
    }
    labels
}

#[test]
fn every_number_is_that_of_a_version_written_from_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let [truth_path, path] = ["truth.txt", "prediction.txt"].map(|name| folder.path().join(name));
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut followed, mut released) = (0, 0);
    for round in 0..400 {
        let samples = random.random_range(1..2500);
        let longest = [40, 250, 600][round % 3];
        let truth = random_labels(&mut random, samples, longest);
        let prediction = if round % 4 == 0 {
            random_labels(&mut random, samples, longest)
        } else {
            follower(&mut random, &truth)
        };
        std::fs::write(&truth_path, lines(&truth)).unwrap();
        std::fs::write(&path, lines(&prediction)).unwrap();
        let arguments = Arguments {
            truth: vec![truth_path.clone()],
            prediction: path.clone(),
            buffer: [200, 61, 120][round % 3],
            strict: round % 5 == 1,
            allow_relax: round % 7 < 2,
            delay: [None, Some(51), Some(7)][round / 3 % 3],
            label_lag: LabelLag::default(),
            as_recorded: false,
            json: true,
        };
        let rule = Rule {
            buffer: arguments.buffer,
            strict: arguments.strict,
            allow_relax: arguments.allow_relax,
        };
        let expected = naive::score(&truth, &prediction, &rule, arguments.delay.unwrap_or(0));
        match (report(&arguments), expected) {
            (Ok(found), Some(expected)) => {
                let found: serde_json::Value = serde_json::from_str(&found).unwrap();
                followed += found["correct"].as_u64().unwrap();
                let gestures = found["gestures"].as_array().unwrap().iter();
                released += gestures.filter(|own| own["release"].is_i64()).count();
                naive::compare(&found, &expected, round);
            }
            (Err(_), None) => {}
            (found, expected) => panic!("{round}: {found:?}, {expected:?}"),
        }
    }
    assert!(followed > 200 && released > 50, "{followed}, {released}");
}
