//! Training masks, drawn often enough to compare their distribution: golden/masking.json.

use std::collections::BTreeMap;
use std::path::Path;

use myointent_tests::golden;
use presets::masking::{Masks, TRANSITION_BUFFER, Task, poisson_spans};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use serde_json::Value;
use shared::units::WINDOW;

use crate::files::json;
use crate::statistics::{Figure, deviation};

/// Number of draws for each task and kind of window.
const DRAWS: usize = 20_000;
/// Smallest expected number of runs of a length that is compared: smaller counts are not nearly normal.
const LEAST_RUNS: f64 = 25.0;

/// Position of a mask, in the file's words; `None` where nothing is masked.
fn kind(mask: &[bool], last_before_change: Option<usize>) -> Option<&'static str> {
    let hidden = count(mask);
    let around = |t: usize| t - TRANSITION_BUFFER..t + TRANSITION_BUFFER;
    match last_before_change {
        _ if hidden == 0 => None,
        _ if hidden == WINDOW => Some("everything"),
        Some(t)
            if hidden == 2 * TRANSITION_BUFFER
                && t >= TRANSITION_BUFFER
                && mask[around(t)].iter().all(|&m| m) =>
        {
            Some("around_transition")
        }
        _ if mask[WINDOW - hidden..].iter().all(|&m| m) => Some("end"),
        _ => Some("poisson"),
    }
}

fn count(mask: &[bool]) -> usize {
    mask.iter().filter(|&&hidden| hidden).count()
}

fn share(mask: &[bool]) -> f64 {
    count(mask) as f64 / WINDOW as f64
}

/// Lengths of a mask's runs of hidden samples.
fn runs(mask: &[bool]) -> Vec<usize> {
    mask.split(|&hidden| !hidden)
        .map(<[bool]>::len)
        .filter(|&length| length > 0)
        .collect()
}

fn number(of: &Value, key: &str) -> f64 {
    of[key].as_f64().unwrap_or_else(|| panic!("no {key}: {of}"))
}

/// Compares the runs of masks with the file's mean, number a mask and histogram of lengths.
fn check_runs(
    name: &str,
    draws: f64,
    masks: &[Vec<bool>],
    run_mean: &Value,
    each: &Value,
    histogram: &Value,
) {
    let figure = |what: &str, expected, rounding| Figure {
        name: format!("{name}: {what}"),
        draws,
        expected,
        rounding,
    };
    let lengths: Vec<Vec<usize>> = masks.iter().map(|mask| runs(mask)).collect();
    let hidden: Vec<f64> = masks.iter().map(|mask| count(mask) as f64).collect();
    let number_of: Vec<f64> = lengths.iter().map(|runs| runs.len() as f64).collect();
    figure("mean run", run_mean, 5e-4).ratio(&hidden, &number_of);
    figure("runs of a mask", each, 5e-3).mean(&number_of);

    let runs_there = draws * each.as_f64().unwrap();
    for (length, expected) in histogram.as_object().unwrap() {
        let fewer = expected.as_f64().unwrap() * runs_there.min(number_of.iter().sum::<f64>());
        if fewer < LEAST_RUNS {
            continue;
        }
        let long = |&run: &usize| match length.strip_prefix(">=") {
            Some(least) => run >= least.parse::<usize>().unwrap(),
            None => run == length.parse::<usize>().unwrap(),
        };
        let of_this: Vec<f64> = lengths
            .iter()
            .map(|runs| runs.iter().filter(|&run| long(run)).count() as f64)
            .collect();
        figure(&format!("runs of {length}"), expected, 5e-6).ratio(&of_this, &number_of);
    }
}

/// Compares shares of a window, one for each mask of one kind, with the file's summary of them.
fn check_shares(name: &str, summary: &Value, shares: &[f64]) {
    let figure = |what: &'static str| Figure {
        name: format!("{name}: {what}"),
        draws: number(summary, "n"),
        expected: &summary[what],
        rounding: 5e-5,
    };
    figure("mean").mean(shares);
    // This is the error of a normal distribution's deviation, an upper limit: a uniform distribution's is less.
    let spread = deviation(shares);
    let error = figure("std").error(spread / 2.0_f64.sqrt(), shares.len());
    figure("std").within(spread, error);
}

fn check_entry(entry: &Value, rng: &mut ChaCha8Rng) {
    let task = [Task::Intent, Task::Emg, Task::Joint, Task::SelfSupervised]
        [entry["task"].as_u64().unwrap() as usize];
    let change = entry["transition_index_used"].as_u64().map(|t| t as usize);
    let name = format!("{task:?}, change after {change:?}");

    let mut drawn: BTreeMap<&str, Vec<Masks>> = BTreeMap::new();
    for _ in 0..DRAWS {
        let masks = task.draw(WINDOW, change, rng);
        let kinds = (kind(&masks.emg, change), kind(&masks.intent, change));
        let kind = match (task, kinds) {
            (Task::Intent, (None, Some(kind))) => kind,
            (Task::Emg | Task::SelfSupervised, (Some(kind), None)) => kind,
            (Task::Joint, (Some(kind), Some(same))) if kind == same => kind,
            other => panic!("{name}: {other:?}"),
        };
        drawn.entry(kind).or_default().push(masks);
    }

    let mixture = entry["mixture"].as_object().unwrap();
    let total = mixture.values().map(|kind| number(kind, "draws")).sum();
    let never = Value::from(0.0);
    for kind in ["everything", "around_transition", "end", "poisson"] {
        let expected = mixture.get(kind).map_or(&never, |k| &k["probability"]);
        let name = format!("{name}, {kind}");
        let found = drawn.get(kind).map_or(0, Vec::len);
        let figure = Figure {
            name: format!("{name}: probability"),
            draws: total,
            expected,
            rounding: 5e-6,
        };
        figure.probability(found, DRAWS);
        if let (Some(expected), Some(masks)) = (mixture.get(kind), drawn.get(kind)) {
            check_kind(&name, task, expected, masks);
        }
    }
}

fn check_kind(name: &str, task: Task, expected: &Value, masks: &[Masks]) {
    let of = |modality: fn(&Masks) -> &Vec<bool>| -> Vec<Vec<bool>> {
        masks.iter().map(|masks| modality(masks).clone()).collect()
    };
    let (emg, intent) = (of(|masks| &masks.emg), of(|masks| &masks.intent));
    for (key, modality) in [("emg_masked_share", &emg), ("intent_masked_share", &intent)] {
        let shares: Vec<f64> = modality.iter().map(|mask| share(mask)).collect();
        match expected.get(key) {
            Some(summary) => check_shares(&format!("{name}, {key}"), summary, &shares),
            None => assert!(shares.iter().all(|&share| share == 0.0), "{name}, {key}"),
        }
    }
    if let Some(summary) = expected.get("share_masked_in_both") {
        let both = |masks: &Masks| {
            let pairs = masks.emg.iter().zip(&masks.intent);
            pairs.filter(|(emg, intent)| **emg && **intent).count() as f64 / WINDOW as f64
        };
        let both: Vec<f64> = masks.iter().map(both).collect();
        check_shares(&format!("{name}, in both"), summary, &both);
    }
    if let Some(range) = expected.get("masked_range_inclusive") {
        let at = |end: usize| range[end].as_u64().unwrap() as usize;
        let range: Vec<bool> = (0..WINDOW).map(|i| (at(0)..=at(1)).contains(&i)).collect();
        assert!(intent.iter().all(|mask| *mask == range), "{name}");
    }
    if let Some(runs) = expected.get("contiguous_run_length") {
        let modality = if task == Task::Intent { &intent } else { &emg };
        let draws = number(expected, "draws");
        check_runs(
            name,
            draws,
            modality,
            &runs["mean"],
            &runs["runs_per_mask"],
            &runs["histogram"],
        );
    }
}

fn read(golden: &Path) -> Value {
    json(&golden.join("masking.json"))["measured"].take()
}

#[test]
fn every_task_masks_as_the_reference_does() {
    let golden = golden();
    let measured = read(&golden);
    let entries = measured["entries"].as_array().unwrap();
    assert_eq!(entries.len(), 19);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for entry in entries {
        check_entry(entry, &mut rng);
    }
}

#[test]
fn spans_cover_a_window_as_the_references_do() {
    let golden = golden();
    let measured = read(&golden);
    let draws = number(&measured, "draws_per_entry");
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let fixed = measured["poisson_fixed_percentage"].as_object().unwrap();
    assert_eq!(fixed.len(), 3);
    for (share, expected) in fixed {
        let hidden = number(expected, "masked_steps") as usize;
        let masks: Vec<Vec<bool>> = (0..DRAWS)
            .map(|_| poisson_spans(WINDOW, hidden, &mut rng))
            .collect();
        check_runs(
            share,
            draws,
            &masks,
            &expected["run_length_mean"],
            &expected["runs_per_mask"],
            &expected["run_length_histogram"],
        );
        for (position, covered) in expected["coverage_by_position"].as_object().unwrap() {
            let at: usize = position.parse().unwrap();
            let figure = Figure {
                name: format!("{share}: sample {position}"),
                draws,
                expected: covered,
                rounding: 5e-4,
            };
            figure.probability(masks.iter().filter(|mask| mask[at]).count(), DRAWS);
        }
    }
}
