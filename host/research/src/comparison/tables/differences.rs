//! Tables of paired differences: two models on the same subjects.
//!
//! Subjects differ far more than models do, so the standard deviation of the differences is informative
//! where those of the two models are not.

use super::heading::{Heading, set_title};
use super::sheet::{Column, Row, Sheet};
use crate::comparison::results::VariantResults;
use myointent::evaluation::Truth;
use myointent::evaluation::metric::summary::{SubjectScore, Summary};
use myointent::report::cell::{self, Cell, ONE, PAIRED};
use myointent::statistics::MeanSd;

/// A metric of a subject.
type Metric = fn(&SubjectScore) -> Option<f64>;

const METRICS: [(&str, Metric); 2] = [
    ("raw", |score| score.raw_accuracy),
    ("TA", |score| score.transition_accuracy),
];

/// A table with a row per pair `(model, other)` and look-ahead: `model - other`.
pub(super) fn differences(
    heading: &Heading<'_>,
    variant: &VariantResults,
    pairs: &[(&str, &str)],
    truth: Truth,
) -> Sheet {
    let sets = variant.data_sets();
    let mut columns = vec![
        Column::new(heading.rows, ONE),
        Column::new("look-ahead", ONE),
    ];
    for (_, set) in &sets {
        let named =
            |(name, _): &(&str, _)| Column::new(format!("{} {name}", set_title(set)), PAIRED);
        columns.extend(METRICS.iter().map(named));
    }
    let mut sheet = heading.sheet(truth, &[variant], columns);
    for look_ahead in variant.look_aheads() {
        for (model, other) in pairs {
            let summary = |model: &str, set: &str| {
                let score = variant.score(model, set, look_ahead, truth);
                score.map(|score| score.widest())
            };
            let mut cells = vec![
                cell::text(format!("{model} - {other}")),
                cell::text(look_ahead.name()),
            ];
            for (_, set) in &sets {
                let both = summary(model, set).zip(summary(other, set));
                cells.extend(METRICS.iter().map(|(_, metric)| {
                    both.map_or_else(cell::none, |(model, other)| paired(model, other, *metric))
                }));
            }
            if cells[2..].iter().any(|cell| *cell != cell::none()) {
                sheet.rows.push(Row {
                    cells,
                    source: variant.provenance(),
                });
            }
        }
    }
    sheet
}

/// The difference over the subjects for which both models have the metric.
fn paired(model: &Summary, other: &Summary, metric: Metric) -> Cell {
    let of = |subject: &str| other.subjects.iter().find(|s| s.subject == subject);
    let differences: Vec<f64> = model
        .subjects
        .iter()
        .filter_map(|score| Some(metric(score)? - metric(of(&score.subject)?)?))
        .collect();
    cell::difference(MeanSd::of(&differences), differences.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::results::fixture::score;

    #[test]
    fn only_subjects_with_both_scores_are_paired() {
        let of = |scores: Vec<SubjectScore>| Summary::of_subjects(scores);
        let model = of(vec![
            score("a", 0.9, &[], 0),
            score("b", 0.5, &[1], 2),
            score("c", 0.1, &[], 1),
        ]);
        let other = of(vec![score("b", 0.4, &[], 2), score("a", 0.6, &[1], 1)]);
        // By hand: +0.3 and +0.1. Only b has a transition accuracy under both models.
        let raw = paired(&model, &other, METRICS[0].1);
        assert_eq!(raw.shown, "+0.200 (0.141) n 2");
        let transition = paired(&model, &other, METRICS[1].1);
        assert_eq!(transition.shown, "+0.500 n 1");
    }
}
