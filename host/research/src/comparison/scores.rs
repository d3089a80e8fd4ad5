//! Tables in the paper's layout: a row for each model and look-ahead, columns by data set.

use std::collections::BTreeSet;

use super::{Column, Outcome, Row, Sheet};
use myointent::evaluation::{ALL, BUFFERS, Score, Truth};
use myointent::report::cell::{self, Cell, MEAN_SD, ONE, Parts, SUPPORT};

/// What a row shows: a model of a variant.
#[derive(Clone, Debug)]
pub(super) struct Line<'a> {
    /// Its name in the table.
    pub label: String,
    /// Whose results.
    pub variant: &'a Outcome,
    /// Which model.
    pub model: &'a str,
}

/// One number of a data set.
pub(super) struct Measure {
    name: &'static str,
    parts: Parts,
    cell: fn(&Score) -> Cell,
}

/// Raw accuracy and transition accuracy with the paper's buffer.
pub(super) const ACCURACY: [Measure; 3] = [
    Measure {
        name: "raw",
        parts: MEAN_SD,
        cell: |score| cell::share(score.widest().raw_accuracy),
    },
    Measure {
        name: "TA",
        parts: MEAN_SD,
        cell: |score| cell::share(score.widest().transition_accuracy),
    },
    SUPPORTED_BY,
];

/// Transition accuracy with every buffer.
pub(super) const BY_BUFFER: [Measure; BUFFERS.len() + 1] = [
    Measure {
        name: "TA 60",
        parts: MEAN_SD,
        cell: |score| cell::share(score.reference[0].transition_accuracy),
    },
    Measure {
        name: "TA 120",
        parts: MEAN_SD,
        cell: |score| cell::share(score.reference[1].transition_accuracy),
    },
    Measure {
        name: "TA 200",
        parts: MEAN_SD,
        cell: |score| cell::share(score.reference[2].transition_accuracy),
    },
    SUPPORTED_BY,
];

const SUPPORTED_BY: Measure = Measure {
    name: "n",
    parts: SUPPORT,
    cell: |score| cell::support(score.widest().subjects.len(), score.widest().events),
};

/// What a table is called and says of itself.
pub(super) struct Heading<'a> {
    /// Start of its file's name.
    pub name: &'a str,
    /// Start of its headline.
    pub title: &'a str,
    /// What is shown.
    pub caption: &'a str,
    /// What the rows are: the name of the first column.
    pub rows: &'a str,
}

impl Heading<'_> {
    /// A table of these columns and no rows yet, marked if folds are missing.
    pub fn sheet(&self, truth: Truth, variants: &[&Outcome], columns: Vec<Column>) -> Sheet {
        let mut title = format!("{}, labels {}", self.title, in_words(truth));
        let mut warnings: Vec<String> = Vec::new();
        let mut seen = BTreeSet::new();
        for variant in variants {
            if !seen.insert(&variant.name) {
                continue;
            }
            if !variant.missing().is_empty() {
                let (there, of) = (variant.runs.len(), variant.of());
                title += &format!(" (`{}`: {there} of {of} folds)", variant.name);
            }
            warnings.extend(variant.warnings());
        }
        Sheet {
            name: format!("{}-{}", self.name, suffix(truth)),
            title,
            caption: self.caption.to_owned(),
            columns,
            rows: Vec::new(),
            warnings,
        }
    }
}

/// One table: without look-ahead first, then with; a model that has no look-ahead keeps its row,
/// empty.
pub(super) fn scores(
    heading: &Heading<'_>,
    lines: &[Line<'_>],
    measures: &[Measure],
    truth: Truth,
) -> Sheet {
    let variants: Vec<&Outcome> = lines.iter().map(|line| line.variant).collect();
    let sets: BTreeSet<(bool, &str)> = variants.iter().flat_map(|v| v.data_sets()).collect();
    let mut columns = vec![
        Column::new(heading.rows, ONE),
        Column::new("look-ahead", ONE),
    ];
    for (_, set) in &sets {
        let named = |measure: &Measure| {
            Column::new(format!("{} {}", shown(set), measure.name), measure.parts)
        };
        columns.extend(measures.iter().map(named));
    }
    let mut sheet = heading.sheet(truth, &variants, columns);
    let judged = |line: &&Line<'_>| {
        let scores = &line.variant.results.published;
        scores
            .iter()
            .any(|score| score.model == line.model && score.truth == truth)
    };
    for ahead in 0..2 {
        for line in lines.iter().filter(judged) {
            let look_ahead = line.variant.look_aheads()[ahead];
            let mut cells = vec![
                cell::text(line.label.as_str()),
                cell::text(look_ahead.name()),
            ];
            for (_, set) in &sets {
                let score = line.variant.score(line.model, set, look_ahead, truth);
                let of = |measure: &Measure| score.map_or_else(cell::none, measure.cell);
                cells.extend(measures.iter().map(of));
            }
            sheet.rows.push(Row {
                cells,
                source: line.variant.provenance(),
            });
        }
    }
    sheet
}

/// Name of a data set in tables.
pub(super) fn shown(data_set: &str) -> &str {
    if data_set == ALL { "pooled" } else { data_set }
}

const fn in_words(truth: Truth) -> &'static str {
    match truth {
        Truth::LagCompensated => "moved",
        Truth::Published => "as published",
    }
}

const fn suffix(truth: Truth) -> &'static str {
    match truth {
        Truth::LagCompensated => "moved",
        Truth::Published => "published",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::fixture::{Fixture, score};

    #[test]
    fn a_model_of_single_labels_has_no_numbers_with_look_ahead() {
        let fixture = Fixture::new();
        let fold = fixture.fold("main", 1, 1);
        let fold = fold.score(score("roshambo/01", 0.5, &[10], 2));
        fold.model("LDA", false).write();
        let main = fixture.variant("main");
        let line = |model| Line {
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
        let lines = [line("LDA"), line("teacher"), line("never judged")];
        let sheet = scores(&heading, &lines, &ACCURACY, Truth::LagCompensated);
        let expected = "\
model              look-ahead  roshambo raw  roshambo TA  roshambo n
-----------  ----------------  ------------  -----------  ----------
our LDA                     0         0.500        0.500       1 / 2
our teacher                 0         0.500        0.500       1 / 2
our LDA      0.25 s, all rows             -            -           -
our teacher  0.25 s, all rows         0.500        0.500       1 / 2
";
        assert_eq!(sheet.table().plain(), expected);
    }
}
