//! The report of model files on any recordings: tables, the worst people first, drawn.

use std::path::Path;

use super::calibrations::calibrations;
use super::cell::number_of;
use super::entry::{Entry, over_all};
use super::page::Page;
use super::people::{COLUMNS, people_of, people_table};
use super::run_report::PEOPLE;
use super::scores::{differences, emitted, is_floor, narrow, sort, table};
use super::{Fact, Table, labels};
use crate::model_evaluation::{
    ALIGNED, AlignedSubject, CALIBRATED, EvaluatedModel, EvaluatedSubject, ModelEvaluation,
    ModelResults, NamedModel, SEEN, Turn, Worn,
};
use crate::{EvaluationError, Score};

/// Writes the report to `page`. `data` names the recordings; `models` are those that were evaluated.
///
/// # Errors
/// When the file cannot be written.
pub fn write(
    evaluation: &ModelEvaluation,
    models: &[NamedModel],
    data: &str,
    page: &Path,
) -> Result<(), EvaluationError> {
    let results = &marked(&evaluation.results);
    let entries = entries(evaluation, models);
    let Some(first) = entries.first() else {
        return Ok(());
    };
    let names: Vec<&str> = entries.iter().map(|entry| &entry.name[..]).collect();
    let mut provenance = vec![(String::new(), facts(results))];
    let of_entry = |entry: &Entry<'_>| (entry.name.clone(), entry.facts.clone());
    provenance.extend(entries.iter().map(of_entry));
    let people = people_table(&first.everybody(), &|subject| remark(results, subject));
    let report = Page {
        title: format!("Evaluation of {}", names.join(", ")),
        summary: format!(
            "On {} of {data}.",
            number_of(results.subjects.len(), "subject")
        ),
        entries: &entries[..entries.len().min(super::MOST_ENTRIES)],
        provenance,
        tables: tables_of_models(results, true),
        people_tables: people.into_iter().collect(),
        notes: notes(),
        ..Page::default()
    };
    report.write(page)
}

/// Notes for the reader of such a page.
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
pub(super) fn entries<'a>(
    evaluation: &'a ModelEvaluation,
    models: &'a [NamedModel],
) -> Vec<Entry<'a>> {
    let results = marked(&evaluation.results);
    let with = |wanted: &dyn Fn(&Score) -> bool| -> Vec<Score> {
        let scores = results.scores.iter();
        scores.filter(|own| wanted(own)).cloned().collect()
    };
    let is_model = |own: &Score| results.models.iter().any(|model| model.name == own.model);
    let numbered = results.models.iter().enumerate();
    numbered
        .map(|(at, model)| Entry {
            name: model.name.clone(),
            facts: model_facts(
                model,
                &seen_by(&evaluation.results, &evaluation.results.models[at].name),
            ),
            scores: with(&|own| own.model == model.name),
            beside: with(&|own| at == 0 && !is_model(own) && !is_floor(own)),
            floors: with(&is_floor),
            recordings: &evaluation.recordings,
            candidate: &evaluation.candidates[at],
            vocabulary: evaluation.vocabulary,
            look_ahead: model.look_ahead,
            panels: Vec::new(),
            bytes: models.get(at).map(|named| &named.bytes[..]),
        })
        .collect()
}

/// Tables: scores of all models and floors; if `wide`, differences of the first model to all others, and labels as emitted;
/// people, the worst first.
#[must_use]
pub fn tables(results: &ModelResults, wide: bool) -> Vec<Table> {
    let results = &marked(results);
    let mut tables = tables_of_models(results, wide);
    let first: Vec<Score> = of_first(results).cloned().collect();
    let everybody: Vec<&Score> = over_all(&first).collect();
    tables.extend(people_table(&everybody, &|subject| {
        remark(results, subject)
    }));
    tables
}

/// Tables of the labels of any program and of the floors: scores; people, the worst first.
#[must_use]
pub fn label_tables(scores: &[Score]) -> Vec<Table> {
    let mut rows: Vec<&Score> = scores.iter().collect();
    sort(&mut rows);
    let caption = "Lag-compensated labels; mean over subjects, with its 95 % interval from six on";
    let own: Vec<Score> = scores
        .iter()
        .filter(|score| !is_floor(score))
        .cloned()
        .collect();
    let people = people_table(&over_all(&own).collect::<Vec<_>>(), &|_| String::new());
    [narrow(caption, &rows)].into_iter().chain(people).collect()
}

/// Caption of the scores of model files.
pub(super) const SCORES: &str = "Lag-compensated labels, each model with its own look-ahead; mean over subjects, with its 95 % interval from six on";

/// Tables: scores of all models and floors; the first model against the others and the floors; alignments.
fn tables_of_models(results: &ModelResults, wide: bool) -> Vec<Table> {
    let mut scores: Vec<&Score> = results.scores.iter().collect();
    sort(&mut scores);
    if !wide {
        let scores = [narrow(SCORES, &scores)].into_iter();
        return scores
            .chain(alignments(results))
            .chain(calibrations(results))
            .collect();
    }
    let pairs = of_first(results).flat_map(|own| {
        let others = results.scores.iter().filter(|other| other.same_people(own));
        let others = others.filter(|other| other.model != own.model);
        others.map(move |other| (own, other))
    });
    let caption = "Differences, paired over subjects; mean [95 % interval] over n subjects";
    let mut tables = vec![
        table(SCORES, &scores),
        differences(caption, false, pairs),
        emitted(&scores),
    ];
    tables.extend(alignments(results));
    tables.extend(calibrations(results));
    tables
}

/// Rows of the first model.
fn of_first(results: &ModelResults) -> impl Iterator<Item = &Score> {
    let first = results.models.first().map(|model| model.name.as_str());
    let scores = results.scores.iter();
    scores.filter(move |score| Some(score.model.as_str()) == first)
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
#[must_use]
pub fn people_rows(results: &ModelResults) -> Table {
    let start = ["subject", "model"].into_iter();
    let names = start.chain(COLUMNS.map(|(name, _)| name));
    let mut table = Table::new("", names.chain(["remark"]));
    let mut models: Vec<&str> = Vec::new();
    for score in &results.scores {
        if !models.contains(&&score.model[..]) {
            models.push(&score.model);
        }
    }
    for model in models {
        for person in people_of(over_all(&results.scores).filter(|score| score.model == model)) {
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
            model.name.clone(),
            count(|_| true),
            count(|own| own.places_off == Some(0)),
            count(|own| own.places_off == Some(1)),
            count(|own| own.places_off.is_some_and(|places| places > 1)),
            count(|own| own.wrong_arm),
            count(|own| own.outcome == "poor-distance"),
            count(|own| own.outcome == "poor-margin"),
            count(|own| own.outcome == "timeout"),
        ]);
    }
    Some(table)
}

/// Results with each model named as on a page: the name says if the model has seen some of the people.
pub(super) fn marked(results: &ModelResults) -> ModelResults {
    let mut marked = results.clone();
    for (at, model) in results.models.iter().enumerate() {
        let mark = mark(seen_by(results, &model.name).len(), results.subjects.len());
        marked.models[at].name += &mark;
        let scores = marked.scores.iter_mut().map(|score| &mut score.model);
        let alignments = marked.alignments.iter_mut().map(|own| &mut own.model);
        let calibrations = marked.calibrations.iter_mut().map(|own| &mut own.model);
        for name in scores.chain(alignments).chain(calibrations) {
            // The model itself, and the same model aligned or calibrated.
            let rest = name.strip_prefix(&model.name);
            if rest.is_some_and(|rest| rest.is_empty() || [ALIGNED, CALIBRATED].contains(&rest)) {
                name.insert_str(model.name.len(), &mark);
            }
        }
    }
    marked
}

/// The evaluated people whom a model has seen.
pub(super) fn seen_by<'a>(results: &'a ModelResults, model: &str) -> Vec<&'a str> {
    let saw = |own: &&EvaluatedSubject| own.seen_by.iter().any(|name| name == model);
    let seen = results.subjects.iter().filter(saw);
    seen.map(|own| &own.subject[..]).collect()
}

/// Suffix of a model's name about the people whom it has seen; empty if it has seen nobody.
fn mark(seen: usize, people: usize) -> String {
    match seen {
        0 => String::new(),
        _ if seen == people => format!("{SEEN}them)"),
        _ => format!("{SEEN}{seen} of {people})"),
    }
}
