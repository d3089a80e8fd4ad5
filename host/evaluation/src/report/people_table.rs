//! Scores of each person as a table.

use super::Table;
use super::cell::quantile;
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
        let subjects = score.widest().subjects.iter();
        subjects.map(|own| Person {
            subject: &own.subject,
            score: own,
            events: {
                let mut all = score.events.subjects.iter();
                all.find(|events| events.subject == own.subject)
            },
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

pub(super) fn cells(person: &Person<'_>) -> [String; COLUMNS.len()] {
    let share = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.3}"));
    let rate = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.1}"));
    let events = person.events;
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
        let remark = [remark(person.subject)];
        table.push(subject.into_iter().chain(cells(&person)).chain(remark));
    }
    Some(table)
}
