//! The report of a run: tables, learning curves, a recording with labels, confusion and offsets.

use std::path::Path;

use shared::units::{LOOK_AHEAD, SAMPLE_PERIOD_MS};

use super::curves::{Curve, Panel};
use super::scores::tables;
use super::timeline::{Timeline, timeline_svg};
use super::{ReportData, ReportError};
use crate::evaluation::{Candidate, EvaluationError, LookAhead, Trial, smooth};
use crate::execution::run_folder::{RunError, RunFolder, write_whole};
use crate::run::config::ResolvedConfig;
use crate::run::context::RunContext;
use crate::run::evaluate::{Evaluation, INTEGER, Results};
use crate::training::metrics::EpochMetrics;

/// Name of the report in a run folder.
pub const REPORT: &str = "report.html";

/// Samples of the recording in the picture: 20 s.
pub(super) const SHOWN: usize = 4000;

/// Writes the report of a run's models to `page`, and its timeline to `timeline.svg` beside it.
///
/// # Errors
/// When a file cannot be written.
pub fn write(
    context: &RunContext,
    results: &Results,
    evaluation: &Evaluation,
    page: &Path,
) -> Result<(), ReportError> {
    let config = &context.config;
    let mut data = ReportData {
        title: format!("Intent detection: preset {}", config.preset.name),
        summary: format!(
            "Trained on {} subjects, evaluated on {} held-out subjects.",
            config.split.training.len(),
            config.split.held_out.len()
        ),
        provenance: provenance(config, results),
        tables: tables(results),
        drawn: "A recording of a held-out subject".to_owned(),
        panels: panels(&context.folder)?,
        notes: notes(),
        ..ReportData::default()
    };
    let integer = evaluation
        .candidates
        .iter()
        .find(|candidate| candidate.name == INTEGER);
    if let Some(candidate) = integer.or(evaluation.candidates.first()) {
        let look_ahead = candidate.condition(evaluation.aggregation);
        let (trials, vocabulary) = (&evaluation.trials, config.preset.vocabulary());
        // The recording with the most transitions.
        if let Some(at) = (0..trials.len()).max_by_key(|&at| changes(&trials[at])) {
            let classes = vocabulary.classes();
            let timeline = timeline(candidate, trials, at, look_ahead, classes)?;
            data.timelines.push(timeline.section(0..SHOWN));
        }
        data.add_errors(candidate, trials, vocabulary, look_ahead)?;
    }
    super::write_html(&data, page)?;
    if let Some(timeline) = data.timelines.first() {
        let picture = timeline_svg(timeline)?;
        write_whole(&page.with_file_name("timeline.svg"), picture.as_bytes())?;
    }
    Ok(())
}

/// What produced the numbers.
fn provenance(config: &ResolvedConfig, results: &Results) -> Vec<(String, String)> {
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
    for (data_set, lag) in &config.lags {
        facts.push((
            format!("label lag of {}", data_set.name()),
            format!("{} ms", lag.samples * SAMPLE_PERIOD_MS as usize),
        ));
    }
    facts
}

fn notes() -> Vec<String> {
    [
        "Labels of these recordings are cues: muscle activity follows a few tenths of a second later. The tables show \
         both labels as published and lag-compensated labels, shifted by one constant per data set that is estimated \
         on training subjects.",
        "Every recording is preceded by its own first 50 ms, repeated to 3 s, so that short recordings are \
         evaluated from their first sample; the device emits no label until it has 3 s of contiguous EMG.",
        "Gestures recognised, latency, false activations and flicker count the labels at the times at which they are \
         emitted, look-ahead included; a missed gesture counts as infinitely late. Balanced, raw and transition \
         accuracy put each label at the time that it is for, as the paper does. Intervals over fewer than about \
         ten people are too narrow.",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// Changes of the true label.
pub(super) fn changes(trial: &Trial) -> usize {
    let labels = &trial.lag_compensated;
    labels.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// One trial with the labels that a candidate emits for it.
pub(super) fn timeline(
    candidate: &Candidate,
    trials: &[Trial],
    at: usize,
    look_ahead: LookAhead,
    classes: usize,
) -> Result<Timeline, EvaluationError> {
    let trial = &trials[at];
    let labels = smooth(
        &candidate.logits[at],
        trial.emg.len(),
        classes,
        candidate.settings(look_ahead),
    )?;
    Ok(Timeline {
        subject: trial.subject.clone(),
        recording: trial.name.clone(),
        emg: trial.emg.clone(),
        truth: trial.lag_compensated.clone(),
        emitted: labels.reference,
        look_ahead_samples: match look_ahead {
            LookAhead::None => 0,
            LookAhead::AllRows | LookAhead::SameInstant => LOOK_AHEAD,
        },
    })
}

/// Learning curves of the models that were trained in the folder.
fn panels(run: &RunFolder) -> Result<Vec<Panel>, RunError> {
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
