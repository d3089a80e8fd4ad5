//! Tables of an evaluation.

use super::cell::{one_ms, share};
use super::table::Table;
use crate::evaluation::metric::summary::Summary;
use crate::evaluation::{LookAhead, Score, Truth};
use crate::run::evaluate::Results;

/// Tables of an evaluation: lag-compensated labels, labels as published, random order and rhythm.
#[must_use]
pub fn tables(results: &Results) -> Vec<Table> {
    let published = |truth: Truth| {
        let lines = results
            .published
            .iter()
            .filter(move |score| score.truth == truth);
        lines.collect::<Vec<_>>()
    };
    let aggregation = results.aggregation;
    [
        (
            "Lag-compensated labels: moved by each data set's lag, to where muscle activity begins",
            published(Truth::LagCompensated),
        ),
        (
            "Labels as published: the cues, as the paper scores",
            published(Truth::Published),
        ),
        (
            "The same people in random order and rhythm, lag-compensated labels",
            results.spliced.iter().collect(),
        ),
    ]
    .into_iter()
    .filter(|(_, scores)| !scores.is_empty())
    .map(|(caption, scores)| table(caption, &scores, aggregation))
    .collect()
}

/// The model that devices run, a row a data set: lag-compensated labels, the aggregation of the model file.
#[must_use]
pub fn summary(results: &Results, model: &str) -> Table {
    let shown: Vec<&Score> = results
        .published
        .iter()
        .filter(|score| {
            score.model == model
                && score.truth == Truth::LagCompensated
                && score.look_ahead == results.aggregation
        })
        .collect();
    table("", &shown, results.aggregation)
}

fn table(caption: &str, scores: &[&Score], aggregation: LookAhead) -> Table {
    let mut table = Table::new(
        caption,
        [
            "recordings",
            "model",
            "look-ahead",
            "raw",
            "TA 60",
            "TA 120",
            "TA 200",
            "offset ms",
            "median",
            "emitted ms",
            "subjects",
            "changes",
        ],
    );
    let mut sets: Vec<&str> = scores.iter().map(|score| score.data_set.as_str()).collect();
    sets.sort_unstable();
    sets.dedup();
    for set in sets {
        let shown = scores
            .iter()
            .filter(|score| score.data_set == set)
            .filter(|score| score.look_ahead == LookAhead::None || score.look_ahead == aggregation);
        for score in shown {
            table.push(row(score));
        }
    }
    table
}

fn row(score: &Score) -> Vec<String> {
    let widest = score.widest();
    let accuracy = |summary: &Summary| share(summary.transition_accuracy).shown;
    let mean = |summary: &Summary| summary.offset.map(|offset| offset.signed.mean);
    let offset = |value: Option<f64>| one_ms(value).shown;
    let mut cells = vec![
        score.data_set.clone(),
        score.model.clone(),
        score.look_ahead.name().to_owned(),
        share(widest.raw_accuracy).shown,
    ];
    cells.extend(score.reference.iter().map(accuracy));
    cells.extend([
        offset(mean(widest)),
        offset(widest.offset.map(|offset| offset.signed_median)),
        offset(mean(&score.emitted)),
        widest.subjects.len().to_string(),
        widest.events.to_string(),
    ]);
    cells
}
