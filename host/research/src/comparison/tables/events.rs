//! Tables of events: what a user counts, from the labels at the times at which they are emitted.

use super::heading::{Heading, ModelRow};
use super::scores::estimate;
use super::sheet::{Column, Sheet};
use myointent::evaluation::{Measure, Truth};
use myointent::report::cell::{self, ESTIMATE, LATENCY, MEAN_SD, Parts};

const RECOGNISED: Parts = &["recognised", "gestures"];

/// A table with a row per data set, look-ahead and model that has a score.
pub(super) fn events(heading: &Heading<'_>, models: &[ModelRow<'_>], truth: Truth) -> Sheet {
    let columns = [
        Column::new("recognised", ESTIMATE),
        Column::new("latency ms", LATENCY),
        Column::new("false/min", MEAN_SD),
        Column::new("flicker/min", MEAN_SD),
        Column::new("n", RECOGNISED),
    ];
    heading.sheet_by_set(truth, models, columns, |score| {
        let events = &score.events;
        vec![
            estimate(score, Measure::Recognition),
            cell::latency(events.latency),
            cell::rate(events.false_activations),
            cell::rate(events.flicker),
            cell::support(events.recognised, events.gestures),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::results::fixture::{Fixture, score};

    #[test]
    fn events_are_over_the_gestures_and_people_of_all_folds() {
        let fixture = Fixture::new();
        let first = score("roshambo/01", 0.5, &[-20, 0, 10], 4);
        fixture.fold("main", 1, 2).score(first).write();
        let second = score("roshambo/02", 0.5, &[20], 1);
        fixture.fold("main", 2, 2).score(second).write();
        let main = fixture.variant("main");
        let teacher = ModelRow {
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
        let sheet = events(&heading, &[teacher], Truth::Published);
        let row: Vec<&str> = sheet.rows[0]
            .cells
            .iter()
            .map(|c| c.shown.as_str())
            .collect();
        // By hand: 3 of 4 and 1 of 1 gestures; 150, 250, 300, 350 ms and one missed.
        assert_eq!(row[..3], ["roshambo", "0", "teacher"]);
        assert_eq!(row[3..5], ["0.875", "300 / missed"]);
        assert_eq!(row[5..], ["2.0 (0.0)", "3.0 (0.0)", "4 / 5"]);
    }
}
