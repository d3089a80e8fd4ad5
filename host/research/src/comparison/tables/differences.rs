//! Tables of paired differences: two models on the same subjects.
//!
//! Subjects differ far more than models do, so the interval of the differences is informative where those of the
//! two models are not.

use super::heading::{Heading, set_title};
use super::sheet::{Column, Row, Sheet};
use crate::comparison::results::VariantResults;
use myointent::evaluation::{CONSTANT, Difference, ENERGY, LookAhead, Measure, Truth};
use myointent::report::cell::{self, ONE, PAIRED};

const MEASURES: [Measure; 3] = [
    Measure::BalancedAccuracy,
    Measure::TransitionAccuracy,
    Measure::Recognition,
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
        let title = |measure: Measure| format!("{} {}", set_title(set), measure.name());
        columns.extend(MEASURES.map(|measure| Column::new(title(measure), PAIRED)));
    }
    let mut sheet = heading.sheet(truth, &[variant], columns);
    for look_ahead in variant.look_aheads() {
        for (model, other) in pairs {
            // A floor has no look-ahead and is compared as it is.
            let score = |model: &str, set: &str| {
                let floor = [CONSTANT, ENERGY].contains(&model);
                let own = if floor { LookAhead::None } else { look_ahead };
                variant.score(model, set, own, truth)
            };
            let mut cells = vec![
                cell::text(format!("{model} - {other}")),
                cell::text(look_ahead.name()),
            ];
            for (_, set) in &sets {
                let both = score(model, set).zip(score(other, set));
                cells.extend(MEASURES.map(|measure| {
                    cell::difference(
                        both.and_then(|(score, other)| Difference::of(measure, score, other)),
                    )
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::results::fixture::{results, score};

    #[test]
    fn only_subjects_with_both_scores_are_paired() {
        let of = |scores| results(scores, &[("m", false)]).published.remove(0);
        let model = of(vec![
            score("x/a", 0.9, &[], 0),
            score("x/b", 0.5, &[1], 2),
            score("x/c", 0.1, &[], 1),
        ]);
        let other = of(vec![score("x/b", 0.4, &[], 2), score("x/a", 0.6, &[1], 1)]);
        // By hand: +0.3 and +0.1. Only b has a transition accuracy under both models.
        let balanced = Difference::of(Measure::BalancedAccuracy, &model, &other);
        assert_eq!(
            cell::difference(balanced).shown,
            "+0.200 n 2, no difference shown"
        );
        let transition = Difference::of(Measure::TransitionAccuracy, &model, &other);
        assert_eq!(
            cell::difference(transition).shown,
            "+0.500 n 1, no difference shown"
        );
    }
}
