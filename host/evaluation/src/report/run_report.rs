//! The report of a run: tables, learning curves, a recording with labels, confusion and offsets.

use std::path::PathBuf;

use super::Fact;
use super::cell::number_of;
use super::entry::Entry;
use super::labels;
use super::page::Page;
use super::people::people_table;
use super::pictures::charts::Panel;
use super::row::Row;
use super::scores::tables;
use crate::results::{Evaluation, Results};
use crate::{Candidate, EvaluatedRecording, EvaluationError, LookAhead, Score, System, Truth};
use execution::run_folder::{EpochMetrics, RunError, RunFolder};
use presets::config::ResolvedConfig;

const REPORT: &str = "report.html";

/// Writes the report of a run's models into its folder, if it has any; returns the place of the file.
pub fn write(
    folder: &RunFolder,
    config: &ResolvedConfig,
    results: &Results,
    evaluation: &Evaluation,
) -> Result<PathBuf, EvaluationError> {
    let page = folder.file(REPORT);
    let mut candidates = evaluation.candidates.iter();
    let integer = candidates.find(|candidate| candidate.model == System::Integer);
    let Some(candidate) = integer.or(evaluation.candidates.first()) else {
        return Ok(page);
    };
    let recordings = &evaluation.recordings;
    let mut entry = entry(config, results, candidate, recordings);
    entry.panels = panels(folder)?;
    contents(config, results, std::slice::from_ref(&entry)).write(&page)?;
    Ok(page)
}

/// The page of one run, its only entry.
pub(super) fn contents<'a>(
    config: &ResolvedConfig,
    results: &Results,
    entries: &'a [Entry<'a>],
) -> Page<'a> {
    let mut tables = tables(results, true);
    // Lag-compensated labels and the differences to the floors; then the rest.
    let more_tables = tables.split_off(tables.len().min(2));
    let people = |entry: &Entry<'_>| people_table(&entry.everybody(), &|_| String::new());
    Page {
        title: format!("Intent detection: preset {}", config.preset.name),
        summary: format!(
            "Trained on {}, evaluated on {}.",
            number_of(config.split.training.len(), "subject"),
            number_of(config.split.held_out.len(), "held-out subject")
        ),
        entries,
        provenance: vec![(String::new(), provenance(config, results))],
        tables,
        more_tables,
        people_tables: entries.iter().filter_map(people).collect(),
        notes: notes(),
    }
}

/// A run on a page, without its learning curves: `candidate` is drawn.
pub(super) fn entry<'a>(
    config: &ResolvedConfig,
    results: &'a Results,
    candidate: &'a Candidate,
    recordings: &'a [EvaluatedRecording],
) -> Entry<'a> {
    let look_ahead = candidate.condition(results.aggregation);
    let compensated = || {
        let scores = results.published.iter();
        scores.filter(|score| score.truth == Truth::LagCompensated)
    };
    let rows = |wanted: &dyn Fn(&Score) -> bool| {
        let rows = compensated().filter(|score| wanted(score));
        rows.map(Row::new).collect()
    };
    // The same model without look-ahead is in the tables, and would only double the rows of the picture.
    let with_look_ahead = |score: &Score| {
        let mut same = compensated().filter(|own| own.model == score.model);
        score.look_ahead == look_ahead
            || score.look_ahead == LookAhead::None && same.all(|own| own.look_ahead != look_ahead)
    };
    Entry {
        name: candidate.model.to_string(),
        facts: provenance(config, results),
        scores: rows(&|score| score.model == candidate.model && score.look_ahead == look_ahead),
        beside: rows(&|score| {
            !score.model.is_floor() && score.model != candidate.model && with_look_ahead(score)
        }),
        floors: rows(&|score| score.model.is_floor()),
        recordings,
        candidate,
        vocabulary: config.preset.vocabulary(),
        look_ahead,
        panels: Vec::new(),
    }
}

fn provenance(config: &ResolvedConfig, results: &Results) -> Vec<Fact> {
    let sets: Vec<_> = config.lags.keys().map(|set| set.name()).collect();
    let recordings = if config.data.is_some() {
        sets.join(", ")
    } else {
        "synthetic".to_owned()
    };
    let revision = config.git_revision.as_deref().unwrap_or("unknown");
    let facts = [
        ("recordings", recordings),
        ("held out", config.split.held_out.join(", ")),
        ("validation", config.split.validation.join(", ")),
        ("seed", config.preset.seed.to_string()),
        ("revision", revision.to_owned()),
        ("look-ahead", results.aggregation.name().to_owned()),
    ];
    let mut facts = facts.map(|(name, value)| (name.to_owned(), value)).to_vec();
    facts.extend(labels(&config.lags, &results.gestures));
    facts
}

/// Note on the people of a row, and on columns of fewer people.
pub(super) const PEOPLE: &str = "People whose recordings have all classes of the model and people with fewer stand in rows of \
     their own, and no mean is over both. A number of fewer people than its row has says so (n). Intervals are shown from six \
     people on; over fewer than about ten they are too narrow.";

pub(super) fn notes() -> Vec<String> {
    [
        "Labels of these recordings are cues: muscle activity follows a few tenths of a second later. The tables show \
         both labels as published and lag-compensated labels: by each cue's own lag, or by one constant for each data \
         set that is estimated on training subjects. A gesture of which the muscle does not show when its cue was followed has no lag-compensated label and is not scored.",
        "Every recording is preceded by its own first 50 ms, repeated to 3 s, so that short recordings are \
         evaluated from their first sample; the device emits no label until it has 3 s of contiguous EMG.",
        "Gestures recognised, latency, false activations and flicker count the labels at the times at which they are \
         emitted, look-ahead included; a missed gesture counts as infinitely late. Balanced, raw and transition \
         accuracy put each label at the time that it is for, as the paper does.",
        PEOPLE,
    ]
    .map(str::to_owned)
    .to_vec()
}

/// Learning curves of the models that were trained in the folder.
pub(super) fn panels(run: &RunFolder) -> Result<Vec<Panel>, RunError> {
    let mut panels = Vec::new();
    for name in ["teacher", "student"] {
        let mut curves: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
        for line in run.lines::<EpochMetrics>(&format!("{name}.jsonl"))? {
            let shown = |what: &str| ["intent", "label"].contains(&what);
            let named =
                |set| move |(what, value): &(String, f64)| (format!("{set} {what}"), *value);
            let training = line.train.iter().filter(|(what, _)| what != "emg");
            let validation = line.validation.iter().filter(|(what, _)| shown(what));
            let both = training.map(named("training"));
            for (name, value) in both.chain(validation.map(named("validation"))) {
                if !curves.iter().any(|(own, _)| *own == name) {
                    curves.push((name.clone(), Vec::new()));
                }
                let own = curves.iter_mut().filter(|(own, _)| *own == name);
                own.for_each(|(_, points)| points.push((line.epoch as f64, value)));
            }
        }
        if !curves.is_empty() {
            panels.push(Panel {
                title: format!("Loss of the {name}"),
                axis: "epoch",
                curves,
            });
        }
    }
    Ok(panels)
}
