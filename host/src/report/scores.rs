//! Tables of an evaluation.

use super::cell::{one_ms, share};
use super::table::Table;
use crate::evaluation::metric::summary::Summary;
use crate::evaluation::{LookAhead, Score, Truth};
use crate::run::evaluate::Results;

/// Tables of an evaluation: lag-compensated labels, labels as published, spliced recordings.
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
            "Lag-compensated labels: shifted by each data set's lag, to the onset of muscle activity",
            published(Truth::LagCompensated),
        ),
        (
            "Labels as published: the times of the cues, as in the paper's evaluation",
            published(Truth::Published),
        ),
        (
            "Spliced recordings of the same subjects, in random order and rhythm; lag-compensated labels",
            results.spliced.iter().collect(),
        ),
    ]
    .into_iter()
    .filter(|(_, scores)| !scores.is_empty())
    .map(|(caption, scores)| table(caption, &scores, aggregation))
    .collect()
}

/// The scores of one model in 80 columns, a row a data set: lag-compensated labels, the paper's buffer, the
/// model file's aggregation mode.
pub(crate) fn summary(results: &Results, model: &str) -> Table {
    let mut table = Table::new(
        "",
        [
            "recordings",
            "raw acc.",
            "transition acc.",
            "offset ms",
            "emitted ms",
            "subjects",
        ],
    );
    for score in &results.published {
        if score.model == model
            && score.truth == Truth::LagCompensated
            && score.look_ahead == results.aggregation
        {
            let widest = score.widest();
            table.push([
                score.data_set.clone(),
                share(widest.raw_accuracy).shown,
                share(widest.transition_accuracy).shown,
                mean_offset(widest),
                mean_offset(&score.emitted),
                widest.subjects.len().to_string(),
            ]);
        }
    }
    table
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
            "transitions",
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
    let mut cells = vec![
        score.data_set.clone(),
        score.model.clone(),
        score.look_ahead.name().to_owned(),
        share(widest.raw_accuracy).shown,
    ];
    cells.extend(score.reference.iter().map(accuracy));
    cells.extend([
        mean_offset(widest),
        one_ms(widest.offset.map(|offset| offset.signed_median)).shown,
        mean_offset(&score.emitted),
        widest.subjects.len().to_string(),
        widest.events.to_string(),
    ]);
    cells
}

fn mean_offset(summary: &Summary) -> String {
    one_ms(summary.offset.map(|offset| offset.signed.mean)).shown
}
