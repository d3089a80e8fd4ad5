//! The labels of the published evaluation: golden/smoother, offline.

use std::path::Path;

use checks::smoother::{CLASSES, TAIL};
use myointent_research::offline::{OfflineAggregation, Vote, WindowLogits};
use myointent_tests::golden;
use serde_json::Value;
use shared::stream::smoother::AggregationMode;

use crate::files::{json, labels, npy};
use crate::smoother::{SETS, same_instant};

/// Rows of logits, in the order of a file of this set.
fn logits(folder: &Path, set: &str, part: &str) -> Vec<f32> {
    let values: Vec<i16> = npy(&folder.join(format!("{set}.{part}.npy")));
    values
        .iter()
        .map(|value| f32::from(*value) / 256.0)
        .collect()
}

fn offline(case: &Value) -> OfflineAggregation {
    let max_factor = case["weight_max_factor"].as_f64().unwrap();
    OfflineAggregation {
        mode: match same_instant(case) {
            true => AggregationMode::SameInstant,
            false => AggregationMode::AllRowsFrom,
        },
        vote: match case["likelihood_format"].as_str() {
            Some("logits") => Vote::MeanLogits { max_factor },
            Some("argmax") => Vote::Majority,
            other => panic!("vote {other:?}"),
        },
        look_ahead: case["lookahead"].as_u64().unwrap() as usize,
        hold: case["samples_between_prediction"].as_u64().unwrap() as usize,
    }
}

#[test]
fn offline_labels_are_the_references_in_every_case() {
    let Some(golden) = golden("offline_labels_are_the_references_in_every_case") else {
        return;
    };
    let folder = golden.join("smoother");
    let cases = json(&folder.join("cases.json"));
    let samples = cases["samples"].as_u64().unwrap() as usize;
    let mut judged = 0;
    for set in SETS {
        let first = logits(&folder, set, "first_window");
        let tails = logits(&folder, set, "tails");
        for case in cases["sets"][set]["offline"].as_array().unwrap() {
            let offline = offline(case);
            let stride = case["stride"].as_u64().unwrap() as usize;
            let mut windows = WindowLogits::new(CLASSES, stride, offline.look_ahead).unwrap();
            windows.push(&first).unwrap();
            for tail in tails.chunks(TAIL * CLASSES).step_by(stride).skip(1) {
                windows.push(tail).unwrap();
            }
            assert_eq!(
                offline.labels(&windows, samples, CLASSES).unwrap(),
                labels(&case["labels_by_sample"]),
                "{set}, stride {stride}: {offline:?}"
            );
            judged += 1;
        }
    }
    assert_eq!(judged, 102);
}
