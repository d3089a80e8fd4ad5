//! What changes for the same person when the model changes: differences in pairs.
//!
//! People differ far more than models do, so the deviation of the differences says what the two
//! models' own deviations cannot.

use super::scores::{Heading, shown};
use super::{Column, Outcome, Row, Sheet};
use myointent::evaluation::Truth;
use myointent::evaluation::metric::summary::{SubjectScore, Summary};
use myointent::report::cell::{self, Cell, ONE, PAIRED};
use myointent::statistics::MeanSd;

/// A number of a person.
type Value = fn(&SubjectScore) -> Option<f64>;

const VALUES: [(&str, Value); 2] = [
    ("raw", |score| score.raw_accuracy),
    ("TA", |score| score.transition_accuracy),
];

/// One table: a row for each pair `(model, other)` and look-ahead, `model - other`.
pub(super) fn differences(
    heading: &Heading<'_>,
    variant: &Outcome,
    pairs: &[(&str, &str)],
    truth: Truth,
) -> Sheet {
    let sets = variant.data_sets();
    let mut columns = vec![
        Column::new(heading.rows, ONE),
        Column::new("look-ahead", ONE),
    ];
    for (_, set) in &sets {
        let named = |(name, _): &(&str, _)| Column::new(format!("{} {name}", shown(set)), PAIRED);
        columns.extend(VALUES.iter().map(named));
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
                cells.extend(VALUES.iter().map(|(_, value)| {
                    both.map_or_else(cell::none, |(model, other)| paired(model, other, *value))
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

/// Over the people whom both models have a number for.
fn paired(model: &Summary, other: &Summary, value: Value) -> Cell {
    let of = |subject: &str| other.subjects.iter().find(|s| s.subject == subject);
    let differences: Vec<f64> = model
        .subjects
        .iter()
        .filter_map(|score| Some(value(score)? - value(of(&score.subject)?)?))
        .collect();
    cell::difference(MeanSd::of(&differences), differences.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::fixture::score;

    #[test]
    fn only_people_whom_both_have_judged_make_a_pair() {
        let of = |scores: Vec<SubjectScore>| Summary::of_subjects(scores);
        let model = of(vec![
            score("a", 0.9, &[], 0),
            score("b", 0.5, &[1], 2),
            score("c", 0.1, &[], 1),
        ]);
        let other = of(vec![score("b", 0.4, &[], 2), score("a", 0.6, &[1], 1)]);
        // By hand: +0.3 and +0.1; of transitions only b has any with both.
        let raw = paired(&model, &other, VALUES[0].1);
        assert_eq!(raw.shown, "+0.200 (0.141) n 2");
        let transition = paired(&model, &other, VALUES[1].1);
        assert_eq!(transition.shown, "+0.500 n 1");
    }
}
