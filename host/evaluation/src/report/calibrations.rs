//! Table of calibrations: scores before and after.

use super::Table;
use super::cell::{difference, estimate, none};
use super::row::Row;
use crate::model_evaluation::{CalibratedSubject, ModelResults};
use crate::{ALL, Difference, Measure, System};
use recordings::statistics::MeanSd;

/// Loss of balanced accuracy beyond which a person is counted.
const LOSS: f64 = 0.02;

/// Table with a row for each calibrated model and set; `None` if no calibration was asked for.
pub(super) fn calibrations(results: &ModelResults, rows: &[Row<'_>]) -> Option<Table> {
    if results.calibrations.is_empty() {
        return None;
    }
    let header = [
        "model",
        "data set",
        "people",
        "new head",
        "before",
        "after",
        "difference",
        "worst before",
        "worst after",
        "lose 0.02",
        "daily/min before",
        "daily/min after",
    ];
    let caption = "Calibration: balanced accuracy as emitted; people whose new head is used, and who lose more than 0.02; activations a \
        minute of the daily life of others with each person's head";
    let mut table = Table::new(caption, header);
    for after in rows {
        let System::Calibrated(model) = &after.model else {
            continue;
        };
        let is_before = |own: &&Row<'_>| own.model == System::Model(model.clone());
        let mut before = rows.iter().filter(is_before);
        if let Some(before) = before.find(|own| own.same_people(after)) {
            table.push(row(results, model, before, after));
        }
    }
    Some(table)
}

fn row(results: &ModelResults, model: &str, before: &Row<'_>, after: &Row<'_>) -> [String; 12] {
    const BALANCED: Measure = Measure::BalancedAccuracyEmitted;
    let set = format!("{}/", after.data_set);
    let own = results.calibrations.iter().filter(|own| {
        own.model == model && (after.data_set == ALL || own.subject.starts_with(&set))
    });
    let own: Vec<&CalibratedSubject> = own.collect();
    let [old, new] = [before, after].map(|score| BALANCED.values(score));
    let lost = new.iter().filter(|(person, value)| {
        let mut old = old.iter();
        old.any(|(own, old)| own == person && *value < old - LOSS)
    });
    let worst = |values: &[(&str, f64)]| {
        let least = values.iter().map(|(_, value)| *value).reduce(f64::min);
        least.map_or_else(none, |least| format!("{least:.2}"))
    };
    let mean = |score| estimate(BALANCED.mean(score), BALANCED.interval(score));
    let daily = |at: usize| {
        let rates: Vec<f64> = own.iter().filter_map(|own| Some(own.daily?[at])).collect();
        MeanSd::of(&rates).map_or_else(none, |rate| format!("{:.1}", rate.mean))
    };
    [
        after.name.clone(),
        after.data_set.clone(),
        new.len().to_string(),
        own.iter().filter(|own| own.new_head).count().to_string(),
        mean(before),
        mean(after),
        difference(Difference::of(BALANCED, after, before)),
        worst(&old),
        worst(&new),
        lost.count().to_string(),
        daily(0),
        daily(1),
    ]
}
