//! Windows of logits and the reference's live labels of golden/smoother.

use std::path::Path;

use checks::{
    Check,
    smoother::{Case, Set},
};
use serde_json::Value;

use crate::files::{json, labels, npy};

/// Names of the sets of windows in the files.
const SETS: [&str; 3] = ["three_class", "mask_class_wins", "edge_rows"];

/// Returns true if a setting of a case is the second of its two values.
fn second(case: &Value, setting: &str, [first, second]: [&str; 2]) -> bool {
    match case[setting].as_str() {
        Some(found) if found == first => false,
        Some(found) if found == second => true,
        other => panic!("{setting} {other:?}"),
    }
}

/// Returns true if only the instant's own row counts.
fn same_instant(case: &Value) -> bool {
    second(case, "maj_vote_range", ["future", "single"])
}

/// Returns true if the smoother has the case's options: it sums logits, and all windows weigh the same. The reference
/// can also sum probabilities, or weigh windows and rows by their distance.
fn is_supported(case: &Value) -> bool {
    let weight = case["weight_max_factor"].as_f64().unwrap();
    let progressive = second(case, "weighting_method", ["equal", "progressive"]);
    let probabilities = second(case, "likelihood_format", ["logits", "probs"]);
    weight == 1.0 && !progressive && !probabilities
}

fn case(case: &Value) -> Case {
    let class = |class: Option<usize>| class.map(|class| class as u8);
    Case {
        same_instant: same_instant(case),
        look_ahead: case["lookahead"].as_u64().unwrap() as u32,
        hold: case["samples_between_prediction"].as_u64().unwrap() as u32,
        labels: labels(&case["labels_by_inference"])
            .into_iter()
            .map(class)
            .collect(),
    }
}

pub fn live(golden: &Path) -> Check {
    let folder = golden.join("smoother");
    let cases = json(&folder.join("cases.json"));
    let set = |name: &str| Set {
        name: name.into(),
        tails: npy(&folder.join(format!("{name}.tails.npy"))),
        cases: cases["sets"][name]["live"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|case| is_supported(case))
            .map(case)
            .collect(),
    };
    let sets: Vec<Set> = SETS.into_iter().map(set).collect();
    assert_eq!(sets.iter().map(|set| set.cases.len()).sum::<usize>(), 24);
    Check::LiveLabels(sets)
}
