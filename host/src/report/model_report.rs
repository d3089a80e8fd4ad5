//! The report of model files on any recordings: tables, the worst people first, drawn.

use std::path::Path;

use shared::units::SAMPLE_PERIOD_MS;

use super::alignment::{self, placement};
use super::cell::{difference, quantile};
use super::run_report::{SHOWN, changes, timeline};
use super::scores::{COMPARED, table};
use super::{ReportData, ReportError, Table};
use crate::evaluation::metric::event::summary::SubjectEvents;
use crate::evaluation::metric::summary::SubjectScore;
use crate::evaluation::{ALL, Difference, Measure, Score};
use crate::run::model_evaluation::{ModelEvaluation, ModelResults};

/// People who are drawn: the worst ones, and the best.
const WORST: usize = 3;

/// Writes the report to `page`. `data` names the recordings.
///
/// # Errors
/// When the file cannot be written.
pub fn write(evaluation: &ModelEvaluation, data: &str, page: &Path) -> Result<(), ReportError> {
    let results = &evaluation.results;
    let Some(model) = results.models.first() else {
        return Ok(());
    };
    let mut report = ReportData {
        title: format!("Evaluation of {}", model.name),
        summary: format!("On {} subjects of {data}.", results.subjects.len()),
        provenance: facts(results),
        tables: tables(results),
        drawn: "The people with the lowest balanced accuracy, the worst first, then the best one".to_owned(),
        notes: vec![
            "Labels are lag-compensated: those that were cues are shifted by one constant for each data set, estimated on \
             the recordings at hand. The energy detector has its default threshold."
                .to_owned(),
        ],
        ..ReportData::default()
    };
    let (trials, candidate) = (&evaluation.trials, &evaluation.candidates[0]);
    let vocabulary = evaluation.vocabulary;
    let people = people(results);
    let drawn = people
        .iter()
        .take(WORST)
        .chain(people.iter().skip(WORST).last());
    for person in drawn {
        let own = (0..trials.len()).filter(|&at| trials[at].subject == person.subject);
        if let Some(at) = own.max_by_key(|&at| changes(&trials[at])) {
            let classes = vocabulary.classes();
            let timeline = timeline(candidate, trials, at, model.look_ahead, classes)?;
            report.timelines.push(timeline.section(0..SHOWN));
        }
    }
    report.add_errors(candidate, trials, vocabulary, model.look_ahead)?;
    super::write_html(&report, page)
}

/// Scores of all models and floors; differences of the first model to all others; people, the worst first.
#[must_use]
pub fn tables(results: &ModelResults) -> Vec<Table> {
    let mut scores: Vec<&Score> = results.scores.iter().collect();
    scores.sort_by_key(|score| score.data_set.as_str());
    let caption = "Lag-compensated labels, each model with its own look-ahead; mean [95 % interval] over subjects";
    let mut tables = vec![table(caption, &scores), differences(results)];
    tables.extend(alignment::table(results));
    tables.push(people_table(results));
    tables
}

/// The first model against the others and the floors, paired over people.
fn differences(results: &ModelResults) -> Table {
    let caption = "Differences, paired over subjects; mean [95 % interval] over n subjects";
    let measures = COMPARED.map(Measure::name);
    let mut table = Table::new(
        caption,
        ["recordings", "difference"].into_iter().chain(measures),
    );
    for own in of_first(results) {
        let others = results
            .scores
            .iter()
            .filter(|other| other.data_set == own.data_set && other.model != own.model);
        for other in others {
            let cells = [
                own.data_set.clone(),
                format!("{} - {}", own.model, other.model),
            ];
            let paired = |measure| difference(Difference::of(measure, own, other)).shown;
            table.push(cells.into_iter().chain(COMPARED.map(paired)));
        }
    }
    table
}

/// Rows of the first model.
fn of_first(results: &ModelResults) -> impl Iterator<Item = &Score> {
    let first = results.models.first().map(|model| model.name.as_str());
    results
        .scores
        .iter()
        .filter(move |score| Some(score.model.as_str()) == first)
}

/// The scores of one person under one model.
struct Person<'a> {
    subject: &'a str,
    score: &'a SubjectScore,
    events: Option<&'a SubjectEvents>,
}

/// The people of one model's row, the lowest balanced accuracy first, those without one last.
fn people_of(score: &Score) -> Vec<Person<'_>> {
    let events = |subject: &str| {
        let mut all = score.events.subjects.iter();
        all.find(|events| events.subject == subject)
    };
    let mut people: Vec<Person<'_>> = score
        .widest()
        .subjects
        .iter()
        .map(|own| Person {
            subject: &own.subject,
            score: own,
            events: events(&own.subject),
        })
        .collect();
    let key = |person: &Person<'_>| person.score.balanced_accuracy.unwrap_or(f64::INFINITY);
    people.sort_by(|a, b| key(a).total_cmp(&key(b)));
    people
}

/// The people of the first model, over all data sets.
fn people(results: &ModelResults) -> Vec<Person<'_>> {
    let over_all = of_first(results).find(|score| score.data_set == ALL);
    over_all
        .or_else(|| of_first(results).next())
        .map(people_of)
        .unwrap_or_default()
}

/// Columns of a person's scores.
const COLUMNS: [&str; 10] = [
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
];

fn cells(person: &Person<'_>) -> [String; COLUMNS.len()] {
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
    ]
}

/// Remarks on a person: who has seen it, and whether it is a test person.
fn remark(results: &ModelResults, subject: &str) -> String {
    let found = results.subjects.iter().find(|own| own.subject == subject);
    let Some(found) = found else {
        return String::new();
    };
    let mut remarks = Vec::new();
    if found.test {
        remarks.push("test person".to_owned());
    }
    if !found.seen_by.is_empty() {
        remarks.push(format!("seen in training by {}", found.seen_by.join(", ")));
    }
    remarks.join("; ")
}

fn people_table(results: &ModelResults) -> Table {
    let name = results.models.first().map_or("", |model| &model.name);
    let caption = format!("People, the lowest balanced accuracy of {name} first");
    let header = ["subject"].into_iter().chain(COLUMNS).chain(["remark"]);
    let mut table = Table::new(caption, header);
    for person in people(results) {
        let subject = [person.subject.to_owned()];
        let remark = [remark(results, person.subject)];
        table.push(subject.into_iter().chain(cells(&person)).chain(remark));
    }
    table
}

/// A row for each person and model, of all data sets together.
#[must_use]
pub fn people_rows(results: &ModelResults) -> Table {
    let header = ["subject", "model"]
        .into_iter()
        .chain(COLUMNS)
        .chain(["remark"]);
    let mut table = Table::new("", header);
    let several = results.scores.iter().any(|score| score.data_set == ALL);
    for score in &results.scores {
        if several && score.data_set != ALL {
            continue;
        }
        for person in people_of(score) {
            let start = [person.subject.to_owned(), score.model.clone()];
            let remark = [remark(results, person.subject)];
            table.push(start.into_iter().chain(cells(&person)).chain(remark));
        }
    }
    table
}

fn facts(results: &ModelResults) -> Vec<(String, String)> {
    let mut facts: Vec<(String, String)> = results
        .models
        .iter()
        .map(|model| {
            let (revision, seed) = (&model.git_revision, model.seed);
            let text = format!(
                "CRC-32 {}, revision {revision}, seed {seed}, look-ahead {}",
                model.checksum,
                model.look_ahead.name()
            );
            (model.name.clone(), text)
        })
        .collect();
    let mut fact = |name: &str, text: String| {
        if !text.is_empty() {
            facts.push((name.to_owned(), text));
        }
    };
    fact(
        "left out: seen in training",
        results.left_out_seen.join(", "),
    );
    fact("left out: test people", results.left_out_test.join(", "));
    fact("armband", placement(results.worn));
    fact(
        "left out: fewer than two openings of the hand",
        results.left_out_openings.join(", "),
    );
    if results.lost_percent > 0 {
        fact(
            "notifications lost and bridged",
            format!("{} %", results.lost_percent),
        );
    }
    for (data_set, lag) in &results.lags {
        let milliseconds = lag * SAMPLE_PERIOD_MS as usize;
        fact(
            &format!("label lag of {}", data_set.name()),
            format!("{milliseconds} ms"),
        );
    }
    facts
}
