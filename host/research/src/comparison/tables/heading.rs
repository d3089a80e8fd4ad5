//! What the tables of a study have in common: headings, and the models that rows stand for.

use std::collections::BTreeSet;

use super::sheet::{Column, Sheet};
use crate::comparison::results::VariantResults;
use myointent::evaluation::{ALL, Truth};

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
