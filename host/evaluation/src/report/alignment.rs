//! Table of the alignments.

use super::Table;
use crate::model_evaluation::{AlignedSubject, ModelResults, Turn, Worn};

/// Number of people by model and placement found; none if no alignment was asked for.
pub(super) fn table(results: &ModelResults) -> Option<Table> {
    if results.alignments.is_empty() {
        return None;
    }
    let mut table = Table::new(
        "Alignment by two openings of the hand, against the frame of the data set; people",
        [
            "model",
            "people",
            "exact",
            "one place off",
            "further off",
            "other arm",
            "poor: distance",
            "poor: margin",
            "timeout",
        ],
    );
    for model in &results.models {
        let own: Vec<&AlignedSubject> = results
            .alignments
            .iter()
            .filter(|own| own.model == model.name)
            .collect();
        let count = |wanted: &dyn Fn(&AlignedSubject) -> bool| {
            own.iter().filter(|own| wanted(own)).count().to_string()
        };
        table.push([
            model.name.clone(),
            own.len().to_string(),
            count(&|own| own.places_off == Some(0)),
            count(&|own| own.places_off == Some(1)),
            count(&|own| own.places_off.is_some_and(|places| places > 1)),
            count(&|own| own.wrong_arm),
            count(&|own| own.outcome == "poor-distance"),
            count(&|own| own.outcome == "poor-margin"),
            count(&|own| own.outcome == "timeout"),
        ]);
    }
    Some(table)
}

/// Placement of the armband, in words; empty if as in the data sets.
pub(super) fn placement(worn: Worn) -> String {
    let turn = match worn.turn {
        Turn::By(0) => None,
        Turn::By(places) => Some(format!("turned by {places} places")),
        Turn::Any => Some("turned by 0 to 7 places, from person to person".to_owned()),
    };
    let arm = worn.mirrored.then(|| "on the other arm".to_owned());
    let both: Vec<String> = turn.into_iter().chain(arm).collect();
    both.join(", ")
}
