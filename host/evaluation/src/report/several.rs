//! One page for one or several runs and model files, side by side.

use std::path::Path;

use shared::intent::Vocabulary;

use super::cell::number_of;
use super::entry::Entry;
use super::model_report::{self, SCORES};
use super::page::Page;
use super::row::{Row, over_all, sort};
use super::scores::{differences, narrow, table};
use super::{MOST_ENTRIES, Table, people, run_report};
use crate::EvaluationError;
use crate::model_evaluation::ModelEvaluation;
use crate::results::{Evaluation, Results};
use execution::run_folder::RunFolder;
use presets::config::ResolvedConfig;

/// A run or a model file that was evaluated.
pub struct Reported {
    /// Name on the page.
    pub name: String,
    /// Run folder with the learning curves, if there is one.
    pub folder: Option<RunFolder>,
    /// Evaluation of the run or the file.
    pub evaluated: Evaluated,
}

/// Evaluation of a run or a model file.
pub enum Evaluated {
    /// A run on the people whom it holds out: its configuration, the results that its folder keeps, and their recordings and
    /// candidates, of which there is one, that of the model file.
    Run(Box<(ResolvedConfig, Results, Evaluation)>),
    /// A model file alone on any recordings.
    Model(Box<ModelEvaluation>),
}

impl Reported {
    /// Name on the page of several, which says if it has seen some of the people.
    fn shown_name(&self) -> String {
        match &self.evaluated {
            Evaluated::Run(_) => self.name.clone(),
            Evaluated::Model(own) => model_report::shown_name(&own.results, &self.name),
        }
    }

    /// Classes of the model.
    pub fn vocabulary(&self) -> Vocabulary {
        match &self.evaluated {
            Evaluated::Run(run) => run.0.preset.vocabulary(),
            Evaluated::Model(own) => own.vocabulary,
        }
    }

    fn entry(&self) -> Result<Entry<'_>, EvaluationError> {
        let mut entry = match &self.evaluated {
            Evaluated::Run(run) => {
                let (config, results, evaluation) = &**run;
                run_report::entry(
                    config,
                    results,
                    &evaluation.candidates[0],
                    &evaluation.recordings,
                )
            }
            Evaluated::Model(own) => {
                let mut entry = model_report::entries(own).remove(0);
                entry.facts.extend(model_report::facts(&own.results));
                entry
            }
        };
        if let Some(folder) = &self.folder {
            entry.panels = run_report::panels(folder)?;
        }
        Ok(entry)
    }
}

/// The tables that the terminal shows: the page's if `wide`, else what matters in them.
pub fn tables(reported: &[Reported], wide: bool) -> Result<Vec<Table>, EvaluationError> {
    Ok(match only(reported) {
        Some(Evaluated::Run(run)) => super::scores::tables(&run.1, wide),
        Some(Evaluated::Model(own)) => model_report::tables(&own.results, wide),
        None => side_by_side(&entries(reported)?, wide),
    })
}

/// The evaluation, if there is one alone.
fn only(reported: &[Reported]) -> Option<&Evaluated> {
    match reported {
        [only] => Some(&only.evaluated),
        _ => None,
    }
}

/// Writes the page. `data` names the recordings of model files; at most [`MOST_ENTRIES`] are drawn.
///
/// # Errors
/// When the file cannot be written, or the metrics of a run cannot be read.
pub fn write(reported: &[Reported], data: &str, page: &Path) -> Result<(), EvaluationError> {
    let entries = entries(reported)?;
    if let Some(Evaluated::Run(run)) = only(reported) {
        return run_report::contents(&run.0, &run.1, &entries).write(page);
    }
    several(reported, &entries, data).write(page)
}

/// Entries of the page; several are named as they are on the page.
fn entries(reported: &[Reported]) -> Result<Vec<Entry<'_>>, EvaluationError> {
    let mut entries = Vec::new();
    for own in reported.iter().take(MOST_ENTRIES) {
        let mut entry = own.entry()?;
        if reported.len() > 1 {
            entry.name = own.shown_name();
            for row in &mut entry.scores {
                row.name.clone_from(&entry.name);
            }
            for panel in &mut entry.panels {
                panel.title += &format!(", {}", own.name);
            }
            entry.beside.clear();
        }
        entries.push(entry);
    }
    name_floors(&mut entries);
    Ok(entries)
}

/// Names floors over other people, or fitted to others, after the entry that they belong to.
fn name_floors(entries: &mut [Entry<'_>]) {
    for at in 1..entries.len() {
        let (before, from) = entries.split_at_mut(at);
        let own = &mut from[0];
        let same = |floor: &Row<'_>| before.iter().all(|first| first.floors.contains(floor));
        if !own.floors.iter().all(same) {
            for floor in &mut own.floors {
                floor.name += &format!(" ({})", own.name);
            }
        }
    }
}

fn several<'a>(reported: &[Reported], entries: &'a [Entry<'a>], data: &str) -> Page<'a> {
    let names: Vec<&str> = entries.iter().map(|entry| &entry.name[..]).collect();
    let counts = entries.iter().map(|entry| {
        let people = over_all(&entry.scores).map(|score| score.widest().subjects.len());
        format!("{} on {}", entry.name, number_of(people.sum(), "subject"))
    });
    let mut summary = counts.collect::<Vec<_>>().join(", ");
    let mut notes = Vec::new();
    let is_run = |own: &Reported| matches!(own.evaluated, Evaluated::Run(_));
    if !reported.iter().all(is_run) {
        notes.extend(model_report::notes());
        summary += &format!(", of {data}");
    }
    if reported.iter().any(is_run) {
        notes.extend(run_report::notes());
    }
    let seen = reported.iter().any(|own| own.name != own.shown_name());
    let whom = if seen {
        "A model that has seen people of its row in training says so beside its name: on them it is too good."
    } else {
        "Each model is evaluated on the people whom it has not seen."
    };
    if entries.len() > 1 {
        notes.push(format!(
            "{whom} Those may be others than another model's: means side by side compare people too. Differences are paired over \
             the people they share."
        ));
    } else if seen {
        notes.push(whom.to_owned());
    }
    let mut tables = match only(reported) {
        Some(Evaluated::Model(own)) => model_report::tables(&own.results, true),
        _ => side_by_side(entries, true),
    };
    // The last one is that of the people.
    let people_tables = tables.split_off(tables.len() - 1);
    let provenance = |entry: &Entry<'_>| (entry.name.clone(), entry.facts.clone());
    Page {
        title: format!("Evaluation of {}", names.join(", ")),
        summary: format!("{summary}."),
        entries,
        provenance: entries.iter().map(provenance).collect(),
        tables,
        people_tables,
        notes,
        ..Page::default()
    }
}

/// Tables of scores, differences and people. Differences: of every later entry to every earlier one, data set by data
/// set, and of each to its floors over all recordings.
fn side_by_side(entries: &[Entry<'_>], wide: bool) -> Vec<Table> {
    let scores = entries.iter().flat_map(|own| &own.scores);
    let mut scores: Vec<Row<'_>> = scores.cloned().collect();
    for floor in entries.iter().flat_map(|own| &own.floors) {
        if !scores.contains(floor) {
            scores.push(floor.clone());
        }
    }
    sort(&mut scores);
    if !wide {
        return vec![narrow(SCORES, &scores), people::side_by_side(entries)];
    }
    let mut pairs: Vec<(&Row<'_>, &Row<'_>)> = Vec::new();
    for (at, later) in entries.iter().enumerate() {
        for earlier in &entries[..at] {
            let other = |own: &Row<'_>| earlier.scores.iter().find(|other| other.same_people(own));
            let own = later.scores.iter();
            pairs.extend(own.filter_map(|own| Some((own, other(own)?))));
        }
    }
    for entry in entries {
        for own in over_all(&entry.scores) {
            let floors = entry.floors.iter().filter(|floor| floor.same_people(own));
            pairs.extend(floors.map(|floor| (own, floor)));
        }
    }
    let caption = "Differences, paired over the subjects that both have; mean [95 % interval] over n subjects";
    vec![
        table(SCORES, &scores),
        differences(caption, false, pairs),
        people::side_by_side(entries),
    ]
}
