//! One person's scores before and after a model was tuned.

use super::Table;
use crate::{Measure, Score};

/// Measures that are shown, with their decimals.
const SHOWN: [(Measure, usize); 7] = [
    (Measure::BalancedAccuracy, 3),
    (Measure::TransitionAccuracy, 3),
    (Measure::Recognition, 3),
    (Measure::FalseActivations, 1),
    (Measure::OtherActivations, 1),
    (Measure::Raised, 2),
    (Measure::Flicker, 1),
];

/// Table with a row for each model: the measures of the part held back.
#[must_use]
pub fn table(caption: &str, scores: &[Score]) -> Table {
    let header = SHOWN.map(|(measure, _)| measure.name());
    let mut table = Table::new(caption, ["model", "gestures"].into_iter().chain(header));
    for score in scores {
        let value = |(measure, decimals): (Measure, usize)| {
            let value = measure.mean(score);
            value.map_or_else(String::new, |own| format!("{:.decimals$}", own.mean))
        };
        let start = [score.model.clone(), score.events.gestures.to_string()];
        table.push(start.into_iter().chain(SHOWN.map(value)));
    }
    table
}
