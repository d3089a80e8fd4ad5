//! Who was left out where: the list that every number can be traced with.

use shared::units::SAMPLE_PERIOD_MS;

use super::{Column, Outcome, Row, Sheet};
use myointent::report::cell::{self, ONE};

/// A row for each fold of these variants.
#[must_use]
pub fn folds<'a>(variants: impl IntoIterator<Item = &'a Outcome>) -> Sheet {
    let columns = [
        "variant",
        "fold",
        "trained on",
        "look-ahead",
        "label lag ms",
        "revision",
        "chose the checkpoint",
        "left out",
    ];
    let mut rows = Vec::new();
    for variant in variants {
        for run in &variant.runs {
            let (config, fold) = (&run.config, run.fold());
            let lags = config.lags.iter().map(|(data_set, lag)| {
                let milliseconds = lag.samples * SAMPLE_PERIOD_MS as usize;
                format!("{} {milliseconds}", data_set.name())
            });
            let cells = [
                variant.name.clone(),
                format!("{} of {}", fold.number, fold.of),
                config.split.training.len().to_string(),
                run.results.aggregation.name().to_owned(),
                lags.collect::<Vec<_>>().join(", "),
                run.revision().to_owned(),
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
        title: "Appendix: who was left out".to_owned(),
        caption: "Subjects trained on, the reading of the look-ahead that was chosen on the \
            validation subjects, how far labels were moved, and who chose the checkpoint."
            .to_owned(),
        columns: columns.map(|name| Column::new(name, ONE)).to_vec(),
        rows,
        warnings: Vec::new(),
    }
}
