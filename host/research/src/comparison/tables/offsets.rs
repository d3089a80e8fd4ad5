//! Tables of prediction offsets, the paper's measure: how late a model follows the transitions that it follows, each
//! label at its reference time. Means are over transitions, not over subjects.

use super::heading::{Heading, ModelRow};
use super::sheet::{Column, Sheet};
use myointent::evaluation::Truth;
use myointent::report::cell::{self, MEAN_SD, ONE, Parts};

const FOLLOWED: Parts = &["followed", "transitions"];

/// A table with a row per data set, look-ahead and model that has a score.
pub(super) fn offsets(heading: &Heading<'_>, models: &[ModelRow<'_>], truth: Truth) -> Sheet {
    let columns = [
        Column::new("offset ms", MEAN_SD),
        Column::new("median", ONE),
        Column::new("absolute", MEAN_SD),
        Column::new("n", FOLLOWED),
    ];
    heading.sheet_by_set(truth, models, columns, |score| {
        let summary = score.widest();
        let offset = summary.offset;
        vec![
            cell::signed_ms(offset.map(|offset| offset.signed)),
            cell::one_ms(offset.map(|offset| offset.signed_median)),
            cell::absolute_ms(offset.map(|offset| offset.absolute)),
            cell::support(summary.correct, summary.events),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::results::fixture::{Fixture, score};

    #[test]
    fn offsets_are_over_the_transitions_of_all_folds() {
        let fixture = Fixture::new();
        let first = score("roshambo/01", 0.5, &[-20, 0, 10], 4);
        fixture.fold("main", 1, 2).score(first).write();
        let second = score("roshambo/02", 0.5, &[20], 1);
        fixture.fold("main", 2, 2).score(second).write();
        let main = fixture.variant("main");
        let teacher = ModelRow {
            label: "teacher".to_owned(),
            variant: &main,
            model: "teacher",
        };
        let heading = Heading {
            name: "x",
            title: "X",
            caption: "",
            rows: "model",
        };
        let sheet = offsets(&heading, &[teacher], Truth::Published);
        let row: Vec<&str> = sheet.rows[0]
            .cells
            .iter()
            .map(|c| c.shown.as_str())
            .collect();
        // By hand: -100, 0, 50 and 100 ms.
        let reference = ["+13 (85)", "+25", "63 (48)", "4 / 5"];
        assert_eq!(row[..3], ["roshambo", "0", "teacher"]);
        assert_eq!(row[3..], reference);
    }
}
