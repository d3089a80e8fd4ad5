//! The report of model files on any recordings: tables, the worst people first, drawn.

use std::path::Path;

use super::calibrations::calibrations;
use super::cell::number_of;
use super::entry::Entry;
use super::page::Page;
use super::people::{COLUMNS, people_of, people_table};
use super::row::{Row, over_all, sort};
use super::run_report::PEOPLE;
use super::scores::{differences, emitted, narrow, table};
use super::{Fact, Table, labels};
use crate::model_evaluation::{
    AlignedSubject, EvaluatedModel, EvaluatedSubject, ModelEvaluation, ModelResults, SEEN, Turn,
    Worn,
};
use crate::{EvaluationError, Score, System};
use shared::uart_line::alignment::AlignmentState;

/// Writes the report to `page`. `data` names the recordings.
pub fn write(evaluation: &ModelEvaluation, data: &str, page: &Path) -> Result<(), EvaluationError> {
    let results = &evaluation.results;
    let entries = entries(evaluation);
    let names: Vec<&str> = entries.iter().map(|entry| &entry.name[..]).collect();
    let mut provenance = vec![(String::new(), facts(results))];
    let of_entry = |entry: &Entry<'_>| (entry.name.clone(), entry.facts.clone());
    provenance.extend(entries.iter().map(of_entry));
    let rows = rows(results);
    let report = Page {
        title: format!("Evaluation of {}", names.join(", ")),
        summary: format!(
            "On {} of {data}.",
            number_of(results.subjects.len(), "subject")
        ),
        entries: &entries[..entries.len().min(super::MOST_ENTRIES)],
        provenance,
        tables: tables_of_models(results, &rows, true),
        people_tables: people(results, &rows).into_iter().collect(),
        notes: notes(),
        ..Page::default()
    };
    report.write(page)
}

pub(super) fn notes() -> Vec<String> {
    [
        "Labels are lag-compensated: those that were cues begin where the muscle follows, by each cue's own lag where rest \
         around it shows it, else by one constant for each data set, estimated on training people; the facts below say what \
         was done in each set, and how many gestures are not scored because the muscle does not show when their cue was followed. The energy \
         detector has its default threshold.",
        "Gestures recognised, latency, false activations and flicker count the labels at the times at which they are \
         emitted, look-ahead included; a missed gesture counts as infinitely late.",
        PEOPLE,
    ]
    .map(str::to_owned)
    .to_vec()
}

/// The models of an evaluation; aligned ones stand beside the first.
pub(super) fn entries(evaluation: &ModelEvaluation) -> Vec<Entry<'_>> {
    let results = &evaluation.results;
    let rows = rows(results);
    let with = |wanted: &dyn Fn(&System) -> bool| -> Vec<Row<'_>> {
        let rows = rows.iter().filter(|own| wanted(&own.model));
        rows.cloned().collect()
    };
    let numbered = results.models.iter().enumerate();
    numbered
        .map(|(at, model)| Entry {
            name: shown_name(results, &model.name),
            facts: model_facts(model, &seen_by(results, &model.name)),
            scores: with(&|own| *own == System::Model(model.name.clone())),
            beside: with(&|own| at == 0 && !own.is_floor() && !matches!(own, System::Model(_))),
            floors: with(&System::is_floor),
            recordings: &evaluation.recordings,
            candidate: &evaluation.candidates[at],
            vocabulary: evaluation.vocabulary,
            look_ahead: model.look_ahead,
            panels: Vec::new(),
        })
        .collect()
}

/// Tables: scores of all models and floors; if `wide`, differences of the first model to all others, and labels as emitted;
/// people, the worst first.
pub fn tables(results: &ModelResults, wide: bool) -> Vec<Table> {
    let rows = rows(results);
    let mut tables = tables_of_models(results, &rows, wide);
    tables.extend(people(results, &rows));
    tables
}

/// Table of the people of the first model.
fn people(results: &ModelResults, rows: &[Row<'_>]) -> Option<Table> {
    let of_first: Vec<&Row<'_>> = over_all(rows)
        .filter(|row| is_first(results, row))
        .collect();
    people_table(&of_first, &|subject| remark(results, subject))
}

/// Tables of the labels of any program and of the floors: scores; people, the worst first.
pub fn label_tables(scores: &[Score]) -> Vec<Table> {
    let mut rows: Vec<Row<'_>> = scores.iter().map(Row::new).collect();
    sort(&mut rows);
    let caption = "Lag-compensated labels; mean over subjects, with its 95 % interval from six on";
    let own = over_all(&rows).filter(|row| !row.model.is_floor());
    let people = people_table(&own.collect::<Vec<_>>(), &|_| String::new());
    [narrow(caption, &rows)].into_iter().chain(people).collect()
}

pub(super) const SCORES: &str = "Lag-compensated labels, each model with its own look-ahead; mean over subjects, with its 95 % interval from six on";

/// Tables: scores of all models and floors; the first model against the others and the floors; alignments.
fn tables_of_models(results: &ModelResults, rows: &[Row<'_>], wide: bool) -> Vec<Table> {
    let mut sorted = rows.to_vec();
    sort(&mut sorted);
    let mut tables = if wide {
        let of_first = rows.iter().filter(|row| is_first(results, row));
        let pairs = of_first.flat_map(|own| {
            let others = rows.iter().filter(|other| other.same_people(own));
            let others = others.filter(|other| other.model != own.model);
            others.map(move |other| (own, other))
        });
        let caption = "Differences, paired over subjects; mean [95 % interval] over n subjects";
        vec![
            table(SCORES, &sorted),
            differences(caption, false, pairs),
            emitted(&sorted),
        ]
    } else {
        vec![narrow(SCORES, &sorted)]
    };
    tables.extend(alignments(results));
    tables.extend(calibrations(results, rows));
    tables
}

fn is_first(results: &ModelResults, row: &Row<'_>) -> bool {
    let first = results.models.first();
    first.is_some_and(|model| row.model == System::Model(model.name.clone()))
}

/// Remarks on a person: who has seen it, and whether it is a test person.
fn remark(results: &ModelResults, subject: &str) -> String {
    let remark = |own: &EvaluatedSubject| {
        let test = own.test.then(|| "test person".to_owned());
        let seen = format!("seen in training by {}", own.seen_by.join(", "));
        let both = test
            .into_iter()
            .chain((!own.seen_by.is_empty()).then_some(seen));
        both.collect::<Vec<_>>().join("; ")
    };
    let found = results.subjects.iter().find(|own| own.subject == subject);
    found.map_or_else(String::new, remark)
}

/// Table with a row for each person and model, of all data sets together.
pub fn people_rows(results: &ModelResults) -> Table {
    let start = ["subject", "model"].into_iter();
    let names = start.chain(COLUMNS.map(|(name, _)| name));
    let mut table = Table::new("", names.chain(["remark"]));
    let rows: Vec<Row<'_>> = results.scores.iter().map(Row::new).collect();
    let mut models: Vec<&str> = rows.iter().map(|row| &row.name[..]).collect();
    models.dedup();
    for model in models {
        for person in people_of(over_all(&rows).filter(|row| row.name == model)) {
            let start = [person.subject.to_owned(), model.to_owned()].into_iter();
            let cells = COLUMNS.map(|(_, cell)| cell(&person));
            table.push(start.chain(cells).chain([remark(results, person.subject)]));
        }
    }
    table
}

fn model_facts(model: &EvaluatedModel, seen: &[&str]) -> Vec<Fact> {
    stated([
        ("CRC-32", model.checksum.clone()),
        ("revision", model.git_revision.clone()),
        ("seed", model.seed.to_string()),
        ("look-ahead", model.look_ahead.name().to_owned()),
        ("evaluated although seen in training", seen.join(", ")),
    ])
}

/// Facts that hold for all models of the evaluation.
pub(super) fn facts(results: &ModelResults) -> Vec<Fact> {
    let subjects = results.subjects.iter();
    let evaluated: Vec<&str> = subjects.map(|own| &own.subject[..]).collect();
    let lost = match results.lost_percent {
        0 => String::new(),
        percent => format!("{percent} %"),
    };
    let [seen, test, openings, holds] = [
        &results.left_out_seen,
        &results.left_out_test,
        &results.left_out_openings,
        &results.left_out_holds,
    ]
    .map(|people| people.join(", "));
    let mut facts = stated([
        ("evaluated", evaluated.join(", ")),
        ("left out: seen in training", seen),
        ("left out: test people", test),
        ("armband", placement(results.worn)),
        ("left out: fewer than two openings of the hand", openings),
        ("left out: too few holds to calibrate", holds),
        ("notifications lost and bridged", lost),
    ]);
    facts.extend(labels(&results.lags, &results.gestures));
    facts
}

/// Facts that have a value.
fn stated<const N: usize>(facts: [(&str, String); N]) -> Vec<Fact> {
    let stated = facts.into_iter().filter(|(_, value)| !value.is_empty());
    stated
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// Placement of the armband, in words; empty if as in the data sets.
fn placement(worn: Worn) -> String {
    let turn = match worn.turn {
        Turn::By(0) => None,
        Turn::By(places) => Some(format!("turned by {places} places")),
        Turn::Any => Some("turned by 0 to 7 places, from person to person".to_owned()),
    };
    let arm = worn.mirrored.then(|| "on the other arm".to_owned());
    let both: Vec<String> = turn.into_iter().chain(arm).collect();
    both.join(", ")
}

/// Table of the number of people by model and placement found; none if no alignment was asked for.
fn alignments(results: &ModelResults) -> Option<Table> {
    if results.alignments.is_empty() {
        return None;
    }
    let columns = [
        "people",
        "exact",
        "one place off",
        "further off",
        "other arm",
        "poor: distance",
        "poor: margin",
        "timeout",
    ];
    let caption =
        "Alignment by two openings of the hand, against the frame of the data set; people";
    let mut table = Table::new(caption, ["model"].into_iter().chain(columns));
    for model in &results.models {
        let count = |wanted: fn(&&AlignedSubject) -> bool| {
            let own = results
                .alignments
                .iter()
                .filter(|own| own.model == model.name);
            own.filter(wanted).count().to_string()
        };
        table.push([
            shown_name(results, &model.name),
            count(|_| true),
            count(|own| own.places_off == Some(0)),
            count(|own| own.places_off == Some(1)),
            count(|own| own.places_off.is_some_and(|places| places > 1)),
            count(|own| own.wrong_arm),
            count(|own| own.outcome == AlignmentState::PoorDistance),
            count(|own| own.outcome == AlignmentState::PoorMargin),
            count(|own| own.outcome == AlignmentState::Timeout),
        ]);
    }
    Some(table)
}

/// Rows of results, each named as on a page: the name says if the model has seen some of the people.
fn rows<'a>(results: &'a ModelResults) -> Vec<Row<'a>> {
    let row = |score: &'a Score| {
        let remark = score.model.model().map(|model| mark(results, model));
        let name = score
            .model
            .remarked(&remark.unwrap_or_default())
            .into_owned();
        Row { name, score }
    };
    results.scores.iter().map(row).collect()
}

pub(super) fn shown_name(results: &ModelResults, model: &str) -> String {
    model.to_owned() + &mark(results, model)
}

fn seen_by<'a>(results: &'a ModelResults, model: &str) -> Vec<&'a str> {
    let saw = |own: &&EvaluatedSubject| own.seen_by.iter().any(|name| name == model);
    let seen = results.subjects.iter().filter(saw);
    seen.map(|own| &own.subject[..]).collect()
}

/// Text behind a model's name about the people whom it has seen; empty if it has seen nobody.
fn mark(results: &ModelResults, model: &str) -> String {
    match (seen_by(results, model).len(), results.subjects.len()) {
        (0, _) => String::new(),
        (seen, people) if seen == people => format!("{SEEN}them)"),
        (seen, people) => format!("{SEEN}{seen} of {people})"),
    }
}
