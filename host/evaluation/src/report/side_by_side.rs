//! Tables of several runs and model files.

use super::Table;
use super::cell::difference;
use super::entry::{Entry, over_all};
use super::model_report::SCORES;
use super::scores::{COMPARED, sort, table};
use crate::{Difference, Measure, Score};

/// Tables of scores, differences and people.
pub(super) fn side_by_side(entries: &[Entry<'_>]) -> Vec<Table> {
    let mut scores: Vec<&Score> = entries.iter().flat_map(|own| &own.scores).collect();
    for floor in entries.iter().flat_map(|own| &own.floors) {
        if !scores.contains(&floor) {
            scores.push(floor);
        }
    }
    sort(&mut scores);
    vec![
        table(SCORES, &scores),
        differences(entries),
        people(entries),
    ]
}

/// Table of every later entry against every earlier one, data set by data set, and of each against its floors over all
/// recordings.
fn differences(entries: &[Entry<'_>]) -> Table {
    let caption = "Differences, paired over the subjects that both have; mean [95 % interval] over n subjects";
    let measures = COMPARED.map(Measure::name);
    let mut table = Table::new(
        caption,
        ["recordings", "classes", "difference"]
            .into_iter()
            .chain(measures),
    );
    let mut push = |own: &Score, other: &Score| {
        let paired = |measure| difference(Difference::of(measure, own, other)).shown;
        let cells = [
            own.data_set.clone(),
            own.people_name(),
            format!("{} - {}", own.model, other.model),
        ];
        table.push(cells.into_iter().chain(COMPARED.map(paired)));
    };
    for (at, later) in entries.iter().enumerate() {
        for earlier in &entries[..at] {
            for own in &later.scores {
                let mut others = earlier.scores.iter();
                if let Some(other) = others.find(|other| other.same_people(own)) {
                    push(own, other);
                }
            }
        }
    }
    for entry in entries {
        for own in over_all(&entry.scores) {
            let floors = entry.floors.iter();
            floors
                .filter(|floor| floor.same_people(own))
                .for_each(|floor| push(own, floor));
        }
    }
    table
}

/// Table of balanced and transition accuracy of every person under every entry, in the order of the picture.
fn people(entries: &[Entry<'_>]) -> Table {
    let shown = [
        Measure::BalancedAccuracy,
        Measure::TransitionAccuracy,
        Measure::Recognition,
    ];
    let columns = entries
        .iter()
        .flat_map(|entry| shown.map(|measure| format!("{}: {}", entry.name, measure.name())));
    let mut table = Table::new(
        "People: each entry's scores, empty where it does not evaluate the person",
        ["subject".to_owned()].into_iter().chain(columns),
    );
    let mut subjects: Vec<&str> = Vec::new();
    for score in entries.iter().flat_map(Entry::everybody) {
        for own in &score.widest().subjects {
            if !subjects.contains(&own.subject.as_str()) {
                subjects.push(&own.subject);
            }
        }
    }
    subjects.sort_unstable();
    for subject in subjects {
        let cells = entries.iter().flat_map(|entry| {
            shown.map(|measure| {
                let rows = over_all(&entry.scores);
                let mut values = rows.flat_map(|score| measure.values(score));
                let own = values.find(|(who, _)| *who == subject);
                own.map_or_else(String::new, |(_, value)| format!("{value:.3}"))
            })
        });
        table.push([subject.to_owned()].into_iter().chain(cells));
    }
    table
}
