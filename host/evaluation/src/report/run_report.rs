//! The report of a run: tables, learning curves, a recording with labels, confusion and offsets.

use std::path::Path;

use super::curves::{Curve, Panel};
use super::entry::{Entry, onsets, pictures, timeline};
use super::labels::labels;
use super::people_table::people_table;
use super::scores::tables;
use super::timeline::timeline_svg;
use super::{Fact, ReportData, ReportError};
use crate::results::{Evaluation, INTEGER, Results};
use crate::{CONSTANT, Candidate, ENERGY, LookAhead, Score, Trial, Truth};
use execution::run_folder::EpochMetrics;
use execution::run_folder::{RunError, RunFolder, write_whole};
use presets::config::ResolvedConfig;

/// Name of the report in a run folder.
pub const REPORT: &str = "report.html";

/// Samples of the recording in `timeline.svg`: 20 s.
const SHOWN: usize = 4000;

/// Writes the report of a run's models to `page`, and `timeline.svg`, the recording with the most gestures, beside it.
///
/// # Errors
/// When a file cannot be written.
pub fn write(
    folder: &RunFolder,
    config: &ResolvedConfig,
    results: &Results,
    evaluation: &Evaluation,
    page: &Path,
) -> Result<(), ReportError> {
    let integer = evaluation
        .candidates
        .iter()
        .find(|candidate| candidate.name == INTEGER);
    let Some(candidate) = integer.or(evaluation.candidates.first()) else {
        return Ok(());
    };
    let trials = &evaluation.trials;
    let bytes = integer.and(evaluation.model.as_deref());
    let entry = entry(folder, config, results, candidate, trials, bytes)?;
    super::write_html(&data(config, results, &entry)?, page)?;
    let whole = |at: usize| onsets(&trials[at], &(0..trials[at].emg.len()));
    if let Some(at) = (0..trials.len()).max_by_key(|&at| whole(at)) {
        let classes = entry.vocabulary.classes();
        let timeline = timeline(candidate, trials, at, entry.look_ahead, classes)?;
        let picture = timeline_svg(&timeline.section(0..SHOWN))?;
        write_whole(&page.with_file_name("timeline.svg"), picture.as_bytes())?;
    }
    Ok(())
}

/// The page of one run.
pub(super) fn data(
    config: &ResolvedConfig,
    results: &Results,
    entry: &Entry<'_>,
) -> Result<ReportData, ReportError> {
    let mut tables = tables(results);
    // Lag-compensated labels and the differences to the floors; then the rest.
    let more_tables = tables.split_off(tables.len().min(2));
    Ok(ReportData {
        title: format!("Intent detection: preset {}", config.preset.name),
        summary: format!(
            "Trained on {} subjects, evaluated on {} held-out subjects.",
            config.split.training.len(),
            config.split.held_out.len()
        ),
        provenance: vec![(String::new(), entry.facts.clone())],
        tables,
        more_tables,
        people_tables: people_table(&entry.everybody(), &|_| String::new())
            .into_iter()
            .collect(),
        notes: notes(),
        ..pictures(std::slice::from_ref(entry))?
    })
}

/// A run on a page: `candidate` is drawn, and `bytes` is its model file.
pub(super) fn entry<'a>(
    folder: &RunFolder,
    config: &ResolvedConfig,
    results: &Results,
    candidate: &'a Candidate,
    trials: &'a [Trial],
    bytes: Option<&'a [u8]>,
) -> Result<Entry<'a>, ReportError> {
    let look_ahead = candidate.condition(results.aggregation);
    let is_floor = |score: &&Score| [CONSTANT, ENERGY].contains(&score.model.as_str());
    let compensated = || {
        let scores = results.published.iter();
        scores.filter(|score| score.truth == Truth::LagCompensated)
    };
    let own = |score: &&Score| score.model == candidate.name && score.look_ahead == look_ahead;
    let beside = |score: &&Score| {
        !is_floor(score)
            && score.model != candidate.name
            && [LookAhead::None, look_ahead].contains(&score.look_ahead)
    };
    // The same model without look-ahead is in the tables, and would only double the rows of the picture.
    let with_look_ahead = |score: &&Score| {
        let same = compensated().filter(|own| own.model == score.model);
        score.look_ahead == look_ahead || same.clone().all(|own| own.look_ahead != look_ahead)
    };
    Ok(Entry {
        name: candidate.name.clone(),
        facts: provenance(config, results),
        scores: compensated().filter(own).cloned().collect(),
        beside: compensated()
            .filter(beside)
            .filter(with_look_ahead)
            .cloned()
            .collect(),
        floors: compensated().filter(is_floor).cloned().collect(),
        trials,
        candidate,
        vocabulary: config.preset.vocabulary(),
        look_ahead,
        panels: panels(folder)?,
        bytes,
    })
}

/// Origin of the numbers.
fn provenance(config: &ResolvedConfig, results: &Results) -> Vec<Fact> {
    let recordings = if config.data.is_some() {
        let sets: Vec<_> = config.lags.keys().map(|set| set.name()).collect();
        sets.join(", ")
    } else {
        "synthetic".to_owned()
    };
    let revision = config.git_revision.as_deref().unwrap_or("unknown");
    let mut facts = vec![
        ("recordings".to_owned(), recordings),
        ("held out".to_owned(), config.split.held_out.join(", ")),
        ("validation".to_owned(), config.split.validation.join(", ")),
        ("seed".to_owned(), config.preset.seed.to_string()),
        ("revision".to_owned(), revision.to_owned()),
        (
            "look-ahead".to_owned(),
            results.aggregation.name().to_owned(),
        ),
    ];
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
        let lines: Vec<EpochMetrics> = run.lines(&format!("{name}.jsonl"))?;
        let mut curves: Vec<Curve> = Vec::new();
        let mut add = |name: String, step: usize, value: f64| match curves
            .iter_mut()
            .find(|curve| curve.name == name)
        {
            Some(curve) => curve.points.push((step as f64, value)),
            None => curves.push(Curve {
                name,
                points: vec![(step as f64, value)],
            }),
        };
        for line in &lines {
            for (what, value) in line.train.iter().filter(|(what, _)| what != "emg") {
                add(format!("training {what}"), line.epoch, *value);
            }
            for (what, value) in line
                .validation
                .iter()
                .filter(|(what, _)| what == "intent" || what == "label")
            {
                add(format!("validation {what}"), line.epoch, *value);
            }
        }
        if !curves.is_empty() {
            panels.push(Panel {
                title: format!("Loss of the {name}"),
                step: "epoch".to_owned(),
                curves,
            });
        }
    }
    Ok(panels)
}
