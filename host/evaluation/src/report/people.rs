//! Scores of each person as tables.

use super::cell::{median, p90};
use super::entry::Entry;
use super::row::{Row, over_all};
use super::scores::COMPARED;
use super::table::Table;
use crate::Measure::{Decided, Raised, RestKept};
use crate::metric::event::activation::Rate;
use crate::metric::event::summary::SubjectEvents;
use crate::metric::summary::SubjectScore;

/// The scores of one person under one model.
pub(super) struct PersonScores<'a> {
    /// The subject.
    pub subject: &'a str,
    score: &'a SubjectScore,
    events: Option<&'a SubjectEvents>,
}

/// The people of one model's rows, the lowest balanced accuracy first, missing ones last.
pub(super) fn people_of<'r, 'a: 'r>(
    rows: impl IntoIterator<Item = &'r Row<'a>>,
) -> Vec<PersonScores<'a>> {
    let of = |row: &'r Row<'a>| {
        let score = row.score;
        let events = |subject: &str| {
            let mut all = score.events.subjects.iter();
            all.find(|events| events.subject == subject)
        };
        score.widest().subjects.iter().map(move |own| PersonScores {
            subject: &own.subject,
            score: own,
            events: events(&own.subject),
        })
    };
    let mut people: Vec<PersonScores<'a>> = rows.into_iter().flat_map(of).collect();
    let key = |person: &PersonScores<'_>| person.score.balanced_accuracy.unwrap_or(f64::INFINITY);
    people.sort_by(|a, b| key(a).total_cmp(&key(b)));
    people
}

/// Column of a person's scores: its name, and its cell in the row of a person.
pub(super) type Column = (&'static str, fn(&PersonScores<'_>) -> String);

/// Columns of a person's scores, and their cells; empty where the person has no value.
pub(super) const COLUMNS: [Column; 16] = [
    ("balanced", |own| share(own.score.balanced_accuracy)),
    ("TA", |own| share(own.score.transition_accuracy)),
    ("recognised", |own| own.share(|of| of.recognition)),
    (Decided.name(), |own| own.share(SubjectEvents::decided)),
    ("gestures", |own| {
        own.shown(|of| Some(of.gestures.to_string()))
    }),
    ("latency ms", |own| own.shown(|of| of.latency.map(median))),
    ("p90 ms", |own| own.shown(|of| of.latency.map(p90))),
    ("release ms", |own| own.shown(|of| of.release.map(median))),
    ("release p90", |own| own.shown(|of| of.release.map(p90))),
    ("false/min", |own| own.rate(|of| of.rest)),
    (RestKept.name(), |own| own.share(SubjectEvents::rest_kept)),
    ("other/min", |own| own.rate(|of| of.other_movement)),
    (Raised.name(), |own| own.share(SubjectEvents::raised_share)),
    ("flicker/min", |own| own.rate(|of| of.flicker)),
    ("raw", |own| share(own.score.raw_accuracy)),
    ("classes", |own| own.score.classes.to_string()),
];

impl PersonScores<'_> {
    fn shown(&self, cell: fn(&SubjectEvents) -> Option<String>) -> String {
        self.events.and_then(cell).unwrap_or_default()
    }

    fn share(&self, of: fn(&SubjectEvents) -> Option<f64>) -> String {
        share(self.events.and_then(of))
    }

    fn rate(&self, of: fn(&SubjectEvents) -> Rate) -> String {
        let rate = self.events.and_then(|events| of(events).per_minute());
        rate.map_or_else(String::new, |rate| format!("{rate:.1}"))
    }
}

fn share(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.3}"))
}

/// Table of the people of a model's rows, the lowest balanced accuracy first, each with a remark; none without a row.
pub(super) fn people_table(rows: &[&Row<'_>], remark: &dyn Fn(&str) -> String) -> Option<Table> {
    let people = people_of(rows.iter().copied());
    let model = &rows.first()?.name;
    let caption = match people.len() {
        1 => format!("Person, under {model}"),
        _ => format!("People, the lowest balanced accuracy of {model} first"),
    };
    let names = COLUMNS.map(|(name, _)| name);
    let mut table = Table::new(
        caption,
        ["subject"].into_iter().chain(names).chain(["remark"]),
    );
    for person in people {
        let cells = COLUMNS.map(|(_, cell)| cell(&person)).into_iter();
        let subject = [person.subject.to_owned()].into_iter();
        table.push(subject.chain(cells).chain([remark(person.subject)]));
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
    let people = people_of(rows).into_iter();
    let mut subjects: Vec<&str> = people.map(|person| person.subject).collect();
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
