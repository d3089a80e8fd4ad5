//! The table of folds: which subjects were held out in which run.

use super::sheet::{Column, Row, Sheet};
use crate::comparison::results::VariantResults;
use myointent::report::cell::{self, ONE};

const CAPTION: &str = "Number of training subjects, the look-ahead chosen on the validation subjects, \
    the label lag of each data set, the source revision, and who was held out. The validation subjects \
    also chose the checkpoint.";

/// A row per fold of these variants.
pub(crate) fn folds<'a>(variants: impl IntoIterator<Item = &'a VariantResults>) -> Sheet {
    let columns = [
        "variant",
        "fold",
        "training subjects",
        "look-ahead",
        "label lag",
        "revision",
        "validation subjects",
        "held-out subjects",
    ];
    let mut rows = Vec::new();
    for variant in variants {
        for run in &variant.runs {
            let (config, fold) = (&run.config, run.fold());
            let lags = config
                .lags
                .iter()
                .map(|(data_set, lag)| format!("{} {lag}", data_set.name()));
            let cells = [
                variant.name.clone(),
                format!("{} of {}", fold.number, fold.of),
                config.split.training.len().to_string(),
                run.results.aggregation.name().to_owned(),
                lags.collect::<Vec<_>>().join(", "),
                Vec::from_iter(run.revisions()).join(" and "),
                config.split.validation.join(", "),
                config.split.held_out.join(", "),
            ];
            rows.push(Row {
                cells: cells.map(cell::text).to_vec(),
                source: variant.provenance(),
            });
        }
    }
    Sheet {
        name: "folds".to_owned(),
        title: "Appendix: folds".to_owned(),
        caption: CAPTION.to_owned(),
        columns: columns.map(|name| Column::new(name, ONE)).to_vec(),
        rows,
        warnings: Vec::new(),
    }
}
