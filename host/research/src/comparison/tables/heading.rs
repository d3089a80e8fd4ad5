//! What the tables of a study have in common: headings, and the models that rows stand for.

use std::collections::BTreeSet;

use super::sheet::{Column, Row, Sheet};
use crate::comparison::results::VariantResults;
use myointent::evaluation::{ALL, Score, Truth};
use myointent::report::cell::{self, Cell, ONE};

/// Name, title and caption that the two tables of one kind share.
pub(super) struct Heading<'a> {
    /// Start of the file's name.
    pub(super) name: &'a str,
    /// Start of the headline.
    pub(super) title: &'a str,
    /// What is shown.
    pub(super) caption: &'a str,
    /// What a row stands for: the name of its column.
    pub(super) rows: &'a str,
}

impl Heading<'_> {
    /// A table with these columns and no rows; the headline says if folds are missing.
    pub(super) fn sheet(
        &self,
        truth: Truth,
        variants: &[&VariantResults],
        columns: Vec<Column>,
    ) -> Sheet {
        let mut title = format!("{}, {}", self.title, labels_in_words(truth));
        let mut warnings: Vec<String> = Vec::new();
        let mut seen = BTreeSet::new();
        for variant in variants {
            if !seen.insert(&variant.name) {
                continue;
            }
            if !variant.missing_folds().is_empty() {
                let (present, of) = (variant.runs.len(), variant.fold_count());
                title += &format!(" (`{}`: {present} of {of} folds)", variant.name);
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

    /// A table with a row for each data set, look-ahead and model that has a score. `columns` are those of `cells`, behind
    /// the columns of these three.
    pub(super) fn sheet_by_set(
        &self,
        truth: Truth,
        models: &[ModelRow<'_>],
        columns: impl IntoIterator<Item = Column>,
        cells: impl Fn(&Score) -> Vec<Cell>,
    ) -> Sheet {
        let names = ["recordings", "look-ahead", self.rows];
        let columns = names
            .map(|name| Column::new(name, ONE))
            .into_iter()
            .chain(columns);
        let variants: Vec<_> = models.iter().map(|row| row.variant).collect();
        let mut sheet = self.sheet(truth, &variants, columns.collect());
        let sets: BTreeSet<(bool, &str)> = variants.iter().flat_map(|v| v.data_sets()).collect();
        for (_, set) in sets {
            for ahead in 0..2 {
                for row in models {
                    let look_ahead = row.variant.look_aheads()[ahead];
                    let Some(score) = row.variant.score(row.model, set, look_ahead, truth) else {
                        continue;
                    };
                    let names = [set_title(set), look_ahead.name(), row.label.as_str()];
                    sheet.rows.push(Row {
                        cells: names
                            .into_iter()
                            .map(cell::text)
                            .chain(cells(score))
                            .collect(),
                        source: row.variant.provenance(),
                    });
                }
            }
        }
        sheet
    }
}

/// A model of a variant: what a row shows.
#[derive(Clone, Debug)]
pub(super) struct ModelRow<'a> {
    /// Name in the table.
    pub(super) label: String,
    /// The variant.
    pub(super) variant: &'a VariantResults,
    /// Name of the model in the results.
    pub(super) model: &'a str,
}

/// Name of a data set in tables.
pub(super) fn set_title(data_set: &str) -> &str {
    if data_set == ALL { "pooled" } else { data_set }
}

const fn labels_in_words(truth: Truth) -> &'static str {
    match truth {
        Truth::LagCompensated => "lag-compensated labels",
        Truth::Published => "labels as published",
    }
}

const fn suffix(truth: Truth) -> &'static str {
    match truth {
        Truth::LagCompensated => "lag-compensated",
        Truth::Published => "published",
    }
}
