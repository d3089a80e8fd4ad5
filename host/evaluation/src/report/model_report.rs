//! The report of model files on any recordings: tables, the worst people first, drawn.

use std::path::Path;

use super::alignment::{self, placement};
use super::cell::difference;
use super::entry::{Entry, over_all, pictures};
use super::labels::labels;
use super::people_table::{COLUMNS, cells, people_of, people_table};
use super::run_report::PEOPLE;
use super::scores::{COMPARED, sort, table};
use super::seen::{marked, seen_by};
use super::{Fact, ReportData, ReportError, Table};
use crate::model_evaluation::{EvaluatedModel, ModelEvaluation, ModelResults, NamedModel};
use crate::{CONSTANT, Difference, ENERGY, Measure, Score};

/// Writes the report to `page`. `data` names the recordings; `models` are those that were evaluated.
///
/// # Errors
/// When the file cannot be written.
pub fn write(
    evaluation: &ModelEvaluation,
    models: &[NamedModel],
    data: &str,
    page: &Path,
) -> Result<(), ReportError> {
    let results = &marked(&evaluation.results);
    let entries = entries(evaluation, models);
    let Some(first) = entries.first() else {
        return Ok(());
    };
    let mut tables = scores_and_differences(results);
    tables.extend(alignment::table(results));
    let names: Vec<&str> = entries.iter().map(|entry| &entry.name[..]).collect();
    let mut provenance = vec![(String::new(), facts(results))];
    for entry in &entries {
        provenance.push((entry.name.clone(), entry.facts.clone()));
    }
    let report = ReportData {
        title: format!("Evaluation of {}", names.join(", ")),
        summary: format!("On {} subjects of {data}.", results.subjects.len()),
        provenance,
        tables,
        people_tables: people_table(&first.everybody(), &|subject| remark(results, subject))
            .into_iter()
            .collect(),
        notes: notes(),
        ..pictures(&entries[..entries.len().min(super::MOST_ENTRIES)])?
    };
    super::write_html(&report, page)
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
    let with = |wanted: &dyn Fn(&str) -> bool| -> Vec<Score> {
        let scores = results.scores.iter();
        scores.filter(|own| wanted(&own.model)).cloned().collect()
    };
    let is_model = |name: &str| results.models.iter().any(|own| own.name == name);
    let is_floor = |name: &str| [CONSTANT, ENERGY].contains(&name);
    let numbered = results.models.iter().enumerate();
    numbered
        .map(|(at, model)| Entry {
            name: model.name.clone(),
            facts: model_facts(
                model,
                &seen_by(&evaluation.results, &evaluation.results.models[at].name),
            ),
            scores: with(&|name| name == model.name),
            beside: with(&|name| at == 0 && !is_model(name) && !is_floor(name)),
            floors: with(&is_floor),
            trials: &evaluation.trials,
            candidate: &evaluation.candidates[at],
            vocabulary: evaluation.vocabulary,
            look_ahead: model.look_ahead,
            panels: Vec::new(),
            bytes: models.get(at).map(|named| &named.bytes[..]),
        })
        .collect()
}

/// Tables: scores of all models and floors; differences of the first model to all others; people, the worst first.
#[must_use]
pub fn tables(results: &ModelResults) -> Vec<Table> {
    let results = &marked(results);
    let mut tables = scores_and_differences(results);
    tables.extend(alignment::table(results));
    let first: Vec<Score> = of_first(results).cloned().collect();
    let everybody: Vec<&Score> = over_all(&first).collect();
    tables.extend(people_table(&everybody, &|subject| {
        remark(results, subject)
    }));
    tables
}

/// Caption of the scores of model files.
pub(super) const SCORES: &str = "Lag-compensated labels, each model with its own look-ahead; mean [95 % interval] over subjects";

fn scores_and_differences(results: &ModelResults) -> Vec<Table> {
    let mut scores: Vec<&Score> = results.scores.iter().collect();
    sort(&mut scores);
    vec![table(SCORES, &scores), differences(results)]
}

/// Table of the first model against the others and the floors, paired over people.
fn differences(results: &ModelResults) -> Table {
    let caption = "Differences, paired over subjects; mean [95 % interval] over n subjects";
    let measures = COMPARED.map(Measure::name);
    let mut table = Table::new(
        caption,
        ["recordings", "classes", "difference"]
            .into_iter()
            .chain(measures),
    );
    for own in of_first(results) {
        let others = results
            .scores
            .iter()
            .filter(|other| other.same_people(own) && other.model != own.model);
        for other in others {
            let cells = [
                own.data_set.clone(),
                own.people_name(),
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

/// Table with a row for each person and model, of all data sets together.
#[must_use]
pub fn people_rows(results: &ModelResults) -> Table {
    let header = ["subject", "model"]
        .into_iter()
        .chain(COLUMNS)
        .chain(["remark"]);
    let mut table = Table::new("", header);
    let mut models: Vec<&str> = Vec::new();
    for score in &results.scores {
        if !models.contains(&&score.model[..]) {
            models.push(&score.model);
        }
    }
    for model in models {
        let own = over_all(&results.scores).filter(|score| score.model == model);
        for person in people_of(own) {
            let start = [person.subject.to_owned(), model.to_owned()];
            let remark = [remark(results, person.subject)];
            table.push(start.into_iter().chain(cells(&person)).chain(remark));
        }
    }
    table
}

fn model_facts(model: &EvaluatedModel, seen: &[&str]) -> Vec<Fact> {
    let mut facts = vec![
        ("CRC-32", model.checksum.clone()),
        ("revision", model.git_revision.clone()),
        ("seed", model.seed.to_string()),
        ("look-ahead", model.look_ahead.name().to_owned()),
    ];
    if !seen.is_empty() {
        facts.push(("evaluated although seen in training", seen.join(", ")));
    }
    let facts = facts.into_iter();
    facts
        .map(|(name, value)| (name.to_owned(), value))
        .collect()
}

/// Facts that hold for all models of the evaluation.
pub(super) fn facts(results: &ModelResults) -> Vec<Fact> {
    let mut facts: Vec<Fact> = Vec::new();
    let evaluated = results.subjects.iter().map(|own| own.subject.clone());
    facts.push((
        "evaluated".to_owned(),
        evaluated.collect::<Vec<_>>().join(", "),
    ));
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
    facts.extend(labels(&results.lags, &results.gestures));
    facts
}
