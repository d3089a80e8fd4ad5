//! Look-ahead and hold against the reference's live aggregator: golden/smoother.

use std::path::Path;

use myointent_tests::golden;
use serde_json::Value;
use shared::smoother::{Likelihood, Reading, Settings, Smoother, Weighting};
use shared::units::SampleIndex;

use crate::files::{json, labels, npy};

/// The three classes and MASK, which the reference lets win.
pub const CLASSES: usize = 4;
/// Rows that the files keep of every window.
pub const TAIL: usize = 52;
pub const SETS: [&str; 3] = ["three_class", "mask_class_wins", "edge_rows"];

/// Rows of logits, in the order of a file of this set.
pub fn logits(folder: &Path, set: &str, part: &str) -> Vec<f32> {
    let values: Vec<i16> = npy(&folder.join(format!("{set}.{part}.npy")));
    values
        .iter()
        .map(|value| f32::from(*value) / 256.0)
        .collect()
}

pub fn reading(case: &Value) -> Reading {
    match case["maj_vote_range"].as_str() {
        Some("future") => Reading::AllRowsFrom,
        Some("single") => Reading::SameInstant,
        other => panic!("reading {other:?}"),
    }
}

fn settings(case: &Value) -> Settings {
    let max_factor = case["weight_max_factor"].as_f64().unwrap() as f32;
    Settings {
        reading: reading(case),
        likelihood: match case["likelihood_format"].as_str() {
            Some("logits") => Likelihood::Logits,
            Some("probs") => Likelihood::Probabilities,
            other => panic!("likelihood {other:?}"),
        },
        weighting: match case["weighting_method"].as_str() {
            Some("equal") => Weighting::Equal { max_factor },
            Some("progressive") => Weighting::Progressive { max_factor },
            other => panic!("weighting {other:?}"),
        },
        look_ahead: case["lookahead"].as_u64().unwrap() as usize,
        hold: case["samples_between_prediction"].as_u64().unwrap() as usize,
        row_samples: 1,
    }
}

#[test]
fn live_labels_are_the_references_in_every_case() {
    let Some(golden) = golden("live_labels_are_the_references_in_every_case") else {
        return;
    };
    let folder = golden.join("smoother");
    let cases = json(&folder.join("cases.json"));
    let mut judged = 0;
    for set in SETS {
        let windows: Vec<[[f32; CLASSES]; TAIL]> = logits(&folder, set, "tails")
            .as_chunks::<CLASSES>()
            .0
            .as_chunks::<TAIL>()
            .0
            .iter()
            .map(|oldest_first| {
                let mut rows = *oldest_first;
                rows.reverse();
                rows
            })
            .collect();
        for case in cases["sets"][set]["live"].as_array().unwrap() {
            let settings = settings(case);
            let mut smoother = Smoother::<CLASSES, TAIL>::new(settings, CLASSES).unwrap();
            let emitted: Vec<_> = (599..)
                .zip(&windows)
                .map(|(end, rows)| {
                    let decision = smoother.push(SampleIndex(end), rows)?;
                    assert_eq!(decision.instant.0, end - settings.look_ahead as u32);
                    Some(decision.class)
                })
                .collect();
            assert_eq!(
                emitted,
                labels(&case["labels_by_inference"]),
                "{set}: {settings:?}"
            );
            judged += 1;
        }
    }
    assert_eq!(judged, 120);
}
