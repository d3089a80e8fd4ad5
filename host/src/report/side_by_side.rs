//! Tables of several runs and model files.

use super::Table;
use super::cell::difference;
use super::entry::Entry;
use super::model_report::SCORES;
use super::scores::{COMPARED, table};
use crate::evaluation::{Difference, Measure, Score};

/// Scores, differences, people.
pub(super) fn side_by_side(entries: &[Entry<'_>]) -> Vec<Table> {
    let mut scores: Vec<&Score> = entries.iter().flat_map(|own| &own.scores).collect();
    for floor in entries.iter().flat_map(|own| &own.floors) {
        if !scores.contains(&floor) {
            scores.push(floor);
        }
    }
    scores.sort_by_key(|score| score.data_set.as_str());
    vec![
        table(SCORES, &scores),
        differences(entries),
        people(entries),
    ]
}

/// Every later entry against every earlier one, data set by data set, and each against its floors over all recordings.
fn differences(entries: &[Entry<'_>]) -> Table {
    let caption = "Differences, paired over the subjects that both have; mean [95 % interval] over n subjects";
    let measures = COMPARED.map(Measure::name);
    let mut table = Table::new(
        caption,
        ["recordings", "difference"].into_iter().chain(measures),
    );
    let mut push = |own: &Score, other: &Score| {
        let paired = |measure| difference(Difference::of(measure, own, other)).shown;
        let cells = [
            own.data_set.clone(),
            format!("{} - {}", own.model, other.model),
        ];
        table.push(cells.into_iter().chain(COMPARED.map(paired)));
    };
    for (at, later) in entries.iter().enumerate() {
        for earlier in &entries[..at] {
            for own in &later.scores {
                let same = |other: &&Score| other.data_set == own.data_set;
                if let Some(other) = earlier.scores.iter().find(same) {
                    push(own, other);
                }
            }
        }
    }
    for entry in entries {
        if let Some(own) = entry.over_all() {
            let same = |floor: &&Score| floor.data_set == own.data_set;
            entry
                .floors
                .iter()
                .filter(same)
                .for_each(|floor| push(own, floor));
        }
    }
    table
}

/// Balanced and transition accuracy of every person under every entry, in the order of the picture.
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
        "People: each entry's scores, empty where it has seen the person",
        ["subject".to_owned()].into_iter().chain(columns),
    );
    let mut subjects: Vec<&str> = Vec::new();
    for score in entries.iter().filter_map(Entry::over_all) {
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
                let values = entry.over_all().map(|score| measure.values(score));
                let own = values
                    .into_iter()
                    .flatten()
                    .find(|(who, _)| *who == subject);
                own.map_or_else(String::new, |(_, value)| format!("{value:.3}"))
            })
        });
        table.push([subject.to_owned()].into_iter().chain(cells));
    }
    table
}
