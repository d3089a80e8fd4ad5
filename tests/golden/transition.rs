//! Transition accuracy: equal to the reference's on all of its cases, verdict by verdict.

use evaluation::EvaluationError;
use evaluation::metric::balanced_accuracy::Recalls;
use evaluation::metric::transition::{Rule, TransitionScore, Windows, score};
use myointent_tests::golden;
use serde_json::Value;
use shared::intent::Intent;

use crate::files::{self, json};

fn labels(runs: &Value) -> Vec<Option<Intent>> {
    let intent = |class| Intent::from_class(class).expect("a class of the six");
    let classes = files::labels(runs).into_iter();
    classes.map(|class| class.map(intent)).collect()
}

/// Returns the verdicts as the reference writes them.
fn codes(result: &Result<TransitionScore, EvaluationError>) -> Value {
    match result {
        Err(EvaluationError::SingleSampleLabel(_)) => Value::from("no_change_in_truth_buffer"),
        Err(other) => Value::from(other.to_string()),
        Ok(score) if score.events() == 0 => {
            let held = score.constant.held == score.constant.count;
            Value::from(vec![if held { "ok" } else { "constant_mismatch" }])
        }
        Ok(score) => score.changes.iter().map(|c| c.status.name()).collect(),
    }
}

fn pairs<'a>(ranges: impl IntoIterator<Item = &'a std::ops::Range<usize>>) -> Value {
    ranges
        .into_iter()
        .map(|range| Value::from(vec![range.start, range.end]))
        .collect()
}

/// Compares two numbers, ignoring the last bit, which serde_json's quick float parser may miss.
fn equal(found: Option<f64>, expected: &Value) -> bool {
    let (Some(found), Some(expected)) = (found, expected.as_f64()) else {
        return false;
    };
    found.to_bits().abs_diff(expected.to_bits()) <= 1
}

#[test]
fn every_case_of_the_reference_gets_its_windows_verdicts_and_offsets() {
    let cases = json(&golden().join("transition/cases.json"));
    let cases = cases.as_array().unwrap();
    let mut judged = 0;
    for case in cases {
        let (truth, prediction) = (labels(&case["truth"]), labels(&case["prediction"]));
        let accuracy = Recalls::new(&truth, &prediction).unwrap().raw_accuracy();
        assert!(equal(accuracy, &case["raw_accuracy"]), "{}", case["name"]);
        for width in [60, 120, 200] {
            let expected = &case["buffers"][width.to_string()];
            check(
                &truth,
                &prediction,
                width,
                expected,
                &format!("{} at {width}", case["name"]),
            );
            judged += 1;
        }
    }
    assert_eq!((cases.len(), judged), (266, 798));
}

fn check(
    truth: &[Option<Intent>],
    prediction: &[Option<Intent>],
    buffer: usize,
    expected: &Value,
    name: &str,
) {
    let whole: Vec<Intent> = truth.iter().copied().flatten().collect();
    assert!(truth.iter().all(Option::is_some), "{name}");
    let windows = Windows::new(&whole, buffer);
    assert_eq!(
        pairs(&windows.buffers),
        expected["buffer_windows"],
        "{name}"
    );
    assert_eq!(
        pairs(&windows.maintenance),
        expected["maintenance_windows"],
        "{name}"
    );

    for (strict, allow_relax, key) in [
        (false, false, "verdicts"),
        (true, false, "strict"),
        (false, true, "allow_relax"),
        (true, true, "strict_allow_relax"),
    ] {
        let result = score(
            truth,
            prediction,
            &Rule {
                buffer,
                strict,
                allow_relax,
            },
        );
        let key = if expected.get(key).is_some() {
            key
        } else {
            "error"
        };
        assert_eq!(codes(&result), expected[key], "{name}, {key}");
    }

    if let Ok(score) = score(
        truth,
        prediction,
        &Rule {
            buffer,
            ..Rule::default()
        },
    ) {
        assert_eq!(
            score.events() as u64,
            expected["events"].as_u64().unwrap(),
            "{name}"
        );
        let offsets: Value = score
            .changes
            .iter()
            .map(|c| Value::from(c.offset))
            .collect();
        assert_eq!(offsets, expected["signed_offset"], "{name}");
        let constant = || {
            if score.constant.held == score.constant.count {
                1.0
            } else {
                0.0
            }
        };
        let accuracy = score.accuracy().unwrap_or_else(constant);
        assert!(
            equal(Some(accuracy), &expected["transition_accuracy"]),
            "{name}"
        );
    }
}
