//! The table of an evaluation, for people.

use crate::evaluation::judge::{LookAhead, Truth, Verdict};
use crate::evaluation::metric::summary::Summary;
use crate::report::Table;
use crate::run::stage::Results;
use myointent_research::comparison::cell::{one_ms, share};

/// Tables of an evaluation: labels as published, labels moved, random order and rhythm.
#[must_use]
pub fn tables(results: &Results) -> Vec<Table> {
    let published = |truth: Truth| {
        let lines = results
            .published
            .iter()
            .filter(move |verdict| verdict.truth == truth);
        lines.collect::<Vec<_>>()
    };
    let reading = results.reading;
    [
        (
            "Labels moved by each data set's lag: where the muscles answer",
            published(Truth::Moved),
        ),
        (
            "Labels as published: the cues, as the paper scores",
            published(Truth::Published),
        ),
        (
            "The same people in random order and rhythm, labels moved",
            results.spliced.iter().collect(),
        ),
    ]
    .into_iter()
    .filter(|(_, verdicts)| !verdicts.is_empty())
    .map(|(caption, verdicts)| table(caption, &verdicts, reading))
    .collect()
}

fn table(caption: &str, verdicts: &[&Verdict], reading: LookAhead) -> Table {
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
    let mut sets: Vec<&str> = verdicts
        .iter()
        .map(|verdict| verdict.data_set.as_str())
        .collect();
    sets.sort_unstable();
    sets.dedup();
    for set in sets {
        let shown = verdicts
            .iter()
            .filter(|verdict| verdict.data_set == set)
            .filter(|verdict| {
                verdict.look_ahead == LookAhead::None || verdict.look_ahead == reading
            });
        for verdict in shown {
            table.push(line(verdict));
        }
    }
    table
}

fn line(verdict: &Verdict) -> Vec<String> {
    let widest = verdict.widest();
    let accuracy = |summary: &Summary| share(summary.transition_accuracy).shown;
    let mean = |summary: &Summary| summary.offset.map(|offset| offset.signed.mean);
    let offset = |value: Option<f64>| one_ms(value).shown;
    let mut cells = vec![
        verdict.data_set.clone(),
        verdict.model.clone(),
        verdict.look_ahead.name().to_owned(),
        share(widest.raw_accuracy).shown,
    ];
    cells.extend(verdict.spoken.iter().map(accuracy));
    cells.extend([
        offset(mean(widest)),
        offset(widest.offset.map(|offset| offset.signed_median)),
        offset(mean(&verdict.emitted)),
        widest.subjects.len().to_string(),
        widest.events.to_string(),
    ]);
    cells
}
