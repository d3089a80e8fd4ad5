//! Tables of accuracies: a row per model and look-ahead, columns by data set.

use std::collections::BTreeSet;

use super::heading::{Heading, ModelRow, set_title};
use super::sheet::{Column, Row, Sheet};
use crate::comparison::results::VariantResults;
use myointent::evaluation::{BUFFERS, Measure, Score, Truth};
use myointent::report::cell::{self, Cell, ESTIMATE, MEAN_SD, ONE, Parts, SUPPORT};

/// A metric of a data set: one column.
pub(super) struct Metric {
    name: &'static str,
    parts: Parts,
    cell: fn(&Score) -> Cell,
}

/// Balanced accuracy, transition accuracy with the paper's buffer, gestures recognised; raw accuracy behind.
pub(super) const ACCURACY: [Metric; 5] = [
    Metric {
        name: "balanced",
        parts: ESTIMATE,
        cell: |score| estimate(score, Measure::BalancedAccuracy),
    },
    Metric {
        name: "TA",
        parts: ESTIMATE,
        cell: |score| estimate(score, Measure::TransitionAccuracy),
    },
    Metric {
        name: "recognised",
        parts: ESTIMATE,
        cell: |score| estimate(score, Measure::Recognition),
    },
    Metric {
        name: "raw",
        parts: MEAN_SD,
        cell: |score| cell::share(score.widest().raw_accuracy),
    },
    SUPPORT_COLUMN,
];

/// Transition accuracy with every buffer.
pub(super) const BY_BUFFER: [Metric; BUFFERS.len() + 1] = [
    Metric {
        name: "TA 60",
        parts: MEAN_SD,
        cell: |score| cell::share(score.reference[0].transition_accuracy),
    },
    Metric {
        name: "TA 120",
        parts: MEAN_SD,
        cell: |score| cell::share(score.reference[1].transition_accuracy),
    },
    Metric {
        name: "TA 200",
        parts: MEAN_SD,
        cell: |score| cell::share(score.reference[2].transition_accuracy),
    },
    SUPPORT_COLUMN,
];

const SUPPORT_COLUMN: Metric = Metric {
    name: "n",
    parts: SUPPORT,
    cell: |score| cell::support(score.widest().subjects.len(), score.widest().events),
};

/// Mean over people with its interval.
pub(super) fn estimate(score: &Score, measure: Measure) -> Cell {
    cell::estimate(measure.mean(score), measure.interval(score))
}

/// A table, first the rows without look-ahead, then those with. A model without look-ahead has an empty
/// row there.
pub(super) fn scores(
    heading: &Heading<'_>,
    models: &[ModelRow<'_>],
    metrics: &[Metric],
    truth: Truth,
) -> Sheet {
    let variants: Vec<&VariantResults> = models.iter().map(|row| row.variant).collect();
    let sets: BTreeSet<(bool, &str)> = variants.iter().flat_map(|v| v.data_sets()).collect();
    let mut columns = vec![
        Column::new(heading.rows, ONE),
        Column::new("look-ahead", ONE),
    ];
    for (_, set) in &sets {
        let named = |metric: &Metric| {
            Column::new(format!("{} {}", set_title(set), metric.name), metric.parts)
        };
        columns.extend(metrics.iter().map(named));
    }
    let mut sheet = heading.sheet(truth, &variants, columns);
    let evaluated = |row: &&ModelRow<'_>| {
        let scores = &row.variant.merged.published;
        scores
            .iter()
            .any(|score| score.model == row.model && score.truth == truth)
    };
    for ahead in 0..2 {
        for row in models.iter().filter(evaluated) {
            let look_ahead = row.variant.look_aheads()[ahead];
            let mut cells = vec![
                cell::text(row.label.as_str()),
                cell::text(look_ahead.name()),
            ];
            for (_, set) in &sets {
                let score = row.variant.score(row.model, set, look_ahead, truth);
                let of = |metric: &Metric| score.map_or_else(cell::none, metric.cell);
                cells.extend(metrics.iter().map(of));
            }
            sheet.rows.push(Row {
                cells,
                source: row.variant.provenance(),
            });
        }
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::results::fixture::{Fixture, score};

    #[test]
    fn a_model_without_look_back_has_no_numbers_with_look_ahead() {
        let fixture = Fixture::new();
        let fold = fixture.fold("main", 1, 1);
        let fold = fold.score(score("roshambo/01", 0.5, &[10], 2));
        fold.model("LDA", false).write();
        let main = fixture.variant("main");
        let row = |model| ModelRow {
            label: format!("our {model}"),
            variant: &main,
            model,
        };
        let heading = Heading {
            name: "x",
            title: "X",
            caption: "",
            rows: "model",
        };
        let models = [row("LDA"), row("teacher"), row("not evaluated")];
        let sheet = scores(&heading, &models, &ACCURACY, Truth::LagCompensated);
        let expected = "\
model              look-ahead  roshambo balanced  roshambo TA  roshambo recognised  roshambo raw  roshambo n
-----------  ----------------  -----------------  -----------  -------------------  ------------  ----------
our LDA                     0              0.500        0.500                0.500         0.500       1 / 2
our teacher                 0              0.500        0.500                0.500         0.500       1 / 2
our LDA      0.25 s, all rows                  -            -                    -             -           -
our teacher  0.25 s, all rows              0.500        0.500                0.500         0.500       1 / 2
";
        assert_eq!(sheet.table().plain(), expected);
    }
}
