//! Scores of each person as tables.

use super::cell::quantile;
use super::entry::{Entry, over_all};
use super::scores::COMPARED;
use super::table::Table;
use crate::Score;
use crate::metric::event::summary::SubjectEvents;
use crate::metric::summary::SubjectScore;

/// The scores of one person under one model.
pub(super) struct Person<'a> {
    /// The subject.
    pub subject: &'a str,
    score: &'a SubjectScore,
    events: Option<&'a SubjectEvents>,
}

/// The people of one model's rows, the lowest balanced accuracy first, those without one last.
pub(super) fn people_of<'a>(scores: impl IntoIterator<Item = &'a Score>) -> Vec<Person<'a>> {
    let of = |score: &'a Score| {
        let events = |subject: &str| {
            score
                .events
                .subjects
                .iter()
                .find(|events| events.subject == subject)
        };
        score.widest().subjects.iter().map(move |own| Person {
            subject: &own.subject,
            score: own,
            events: events(&own.subject),
        })
    };
    let mut people: Vec<Person<'a>> = scores.into_iter().flat_map(of).collect();
    let key = |person: &Person<'_>| person.score.balanced_accuracy.unwrap_or(f64::INFINITY);
    people.sort_by(|a, b| key(a).total_cmp(&key(b)));
    people
}

/// Columns of a person's scores.
pub(super) const COLUMNS: [&str; 11] = [
    "balanced",
    "TA",
    "recognised",
    "gestures",
    "latency ms",
    "p90 ms",
    "false/min",
    "other/min",
    "flicker/min",
    "raw",
    "classes",
];

/// Cells of the columns [`COLUMNS`]; empty where the person has no value.
pub(super) fn cells(person: &Person<'_>) -> [String; COLUMNS.len()] {
    let events = person.events;
    let rate = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.1}"));
    let latency = events.and_then(|events| events.latency);
    [
        share(person.score.balanced_accuracy),
        share(person.score.transition_accuracy),
        share(events.and_then(|events| events.recognition)),
        events.map_or_else(String::new, |events| events.gestures.to_string()),
        latency.map_or_else(String::new, |latency| quantile(latency.median)),
        latency.map_or_else(String::new, |latency| quantile(latency.p90)),
        rate(events.and_then(|events| events.rest.per_minute())),
        rate(events.and_then(|events| events.other_movement.per_minute())),
        rate(events.and_then(|events| events.flicker.per_minute())),
        share(person.score.raw_accuracy),
        person.score.classes.to_string(),
    ]
}

fn share(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.3}"))
}

/// Table of the people of a model's rows, the lowest balanced accuracy first, each with a remark; none without a row.
pub(super) fn people_table(scores: &[&Score], remark: &dyn Fn(&str) -> String) -> Option<Table> {
    let caption = format!(
        "People, the lowest balanced accuracy of {} first",
        scores.first()?.model
    );
    let header = ["subject"].into_iter().chain(COLUMNS).chain(["remark"]);
    let mut table = Table::new(caption, header);
    for person in people_of(scores.iter().copied()) {
        let subject = [person.subject.to_owned()];
        table.push(
            subject
                .into_iter()
                .chain(cells(&person))
                .chain([remark(person.subject)]),
        );
    }
    Some(table)
}

/// Table of the accuracies of every person under every entry, in alphabetical order.
pub(super) fn side_by_side(entries: &[Entry<'_>]) -> Table {
    let names =
        |entry: &Entry<'_>| COMPARED.map(|measure| format!("{}: {}", entry.name, measure.name()));
    let mut table = Table::new(
        "People: each entry's scores, empty where it does not evaluate the person",
        ["subject".to_owned()]
            .into_iter()
            .chain(entries.iter().flat_map(names)),
    );
    let rows = entries.iter().flat_map(Entry::everybody);
    let mut subjects: Vec<&str> = people_of(rows)
        .iter()
        .map(|person| person.subject)
        .collect();
    subjects.sort_unstable();
    subjects.dedup();
    for subject in subjects {
        let cells = entries.iter().flat_map(|entry| {
            COMPARED.map(|measure| {
                let mut values = over_all(&entry.scores).flat_map(|score| measure.values(score));
                share(
                    values
                        .find(|(who, _)| *who == subject)
                        .map(|(_, value)| value),
                )
            })
        });
        table.push([subject.to_owned()].into_iter().chain(cells));
    }
    table
}
