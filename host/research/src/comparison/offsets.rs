//! How late the changes come that a model follows: over changes, not over people.

use super::scores::{Heading, Line, shown};
use super::{Column, Row, Sheet};
use myointent::evaluation::Truth;
use myointent::evaluation::metric::summary::Summary;
use myointent::report::cell::{self, Cell, MEAN_SD, ONE, Parts};

const FOLLOWED: Parts = &["followed", "transitions"];

/// One table: a row for each data set, look-ahead and model; nobody without a score has one.
pub(super) fn offsets(heading: &Heading<'_>, lines: &[Line<'_>], truth: Truth) -> Sheet {
    let mut columns = vec![
        Column::new("recordings", ONE),
        Column::new("look-ahead", ONE),
        Column::new(heading.rows, ONE),
    ];
    for book in ["spoken", "emitted"] {
        columns.extend([
            Column::new(format!("{book} ms"), MEAN_SD),
            Column::new(format!("{book} median"), ONE),
            Column::new(format!("{book} absolute"), MEAN_SD),
            Column::new(format!("{book} n"), FOLLOWED),
        ]);
    }
    let variants: Vec<_> = lines.iter().map(|line| line.variant).collect();
    let mut sheet = heading.sheet(truth, &variants, columns);
    let mut sets: Vec<(bool, &str)> = variants.iter().flat_map(|v| v.data_sets()).collect();
    sets.sort_unstable();
    sets.dedup();
    for (_, set) in sets {
        for ahead in 0..2 {
            for line in lines {
                let look_ahead = line.variant.look_aheads()[ahead];
                let Some(score) = line.variant.score(line.model, set, look_ahead, truth) else {
                    continue;
                };
                let mut cells = vec![
                    cell::text(shown(set)),
                    cell::text(look_ahead.name()),
                    cell::text(line.label.as_str()),
                ];
                cells.extend(book(score.widest()));
                cells.extend(book(&score.emitted));
                sheet.rows.push(Row {
                    cells,
                    source: line.variant.provenance(),
                });
            }
        }
    }
    sheet
}

fn book(summary: &Summary) -> [Cell; 4] {
    let offset = summary.offset;
    [
        cell::signed_ms(offset.map(|offset| offset.signed)),
        cell::one_ms(offset.map(|offset| offset.signed_median)),
        cell::absolute_ms(offset.map(|offset| offset.absolute)),
        cell::support(summary.correct, summary.events),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::fixture::{Fixture, score};

    #[test]
    fn offsets_are_over_the_changes_of_all_folds() {
        let fixture = Fixture::new();
        let first = score("roshambo/01", 0.5, &[-20, 0, 10], 4);
        fixture.fold("main", 1, 2).score(first).write();
        let second = score("roshambo/02", 0.5, &[20], 1);
        fixture.fold("main", 2, 2).score(second).write();
        let main = fixture.variant("main");
        let line = Line {
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
        let sheet = offsets(&heading, &[line], Truth::Published);
        let row: Vec<&str> = sheet.rows[0]
            .cells
            .iter()
            .map(|c| c.shown.as_str())
            .collect();
        // By hand: -100, 0, 50, 100 ms; what is emitted comes 250 ms later.
        let spoken = ["+13 (85)", "+25", "63 (48)", "4 / 5"];
        let emitted = ["+263 (85)", "+275", "263 (85)", "4 / 5"];
        assert_eq!(row[..3], ["roshambo", "0", "teacher"]);
        assert_eq!(row[3..7], spoken);
        assert_eq!(row[7..], emitted);
    }
}
