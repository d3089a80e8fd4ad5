//! The report of a run: tables, learning curves, a recording with labels, confusion and offsets.

use std::path::Path;

use shared::units::LOOK_AHEAD;

use super::scores::tables;
use super::{Confusion, Curve, Panel, ReportData, ReportError, Timeline, timeline_svg};
use crate::evaluation::{EvaluationError, LookAhead, confusion, offsets, smooth};
use crate::execution::run_folder::{RunError, RunFolder, write_whole};
use crate::run::config::ResolvedConfig;
use crate::run::context::RunContext;
use crate::run::evaluate::{Evaluation, INTEGER, Results};
use crate::training::metrics::EpochMetrics;

/// Name of the report in a run folder.
pub const REPORT: &str = "report.html";

/// Writes the page that shows what a run's models do.
///
/// # Errors
/// When the page cannot be written.
pub fn write(
    context: &RunContext,
    results: &Results,
    evaluation: &Evaluation,
    page: &Path,
) -> Result<(), ReportError> {
    let (config, preset) = (&context.config, &context.config.preset);
    let mut data = ReportData {
        title: format!("Intent from muscles alone: preset {}", preset.name),
        summary: format!(
            "Trained on {} people, judged on {} people none of the models has seen.",
            config.split.training.len(),
            config.split.held_out.len()
        ),
        tables: tables(results),
        panels: panels(&context.folder)?,
        ..ReportData::default()
    };
    data.provenance = vec![
        (
            "recordings".to_owned(),
            config
                .data
                .as_ref()
                .map_or_else(|| "synthetic".to_owned(), |_| data_sets(config)),
        ),
        ("left out".to_owned(), config.split.held_out.join(", ")),
        (
            "chose the checkpoint".to_owned(),
            config.split.validation.join(", "),
        ),
        ("seed".to_owned(), preset.seed.to_string()),
        (
            "revision".to_owned(),
            config
                .git_revision
                .clone()
                .unwrap_or_else(|| "unknown".to_owned()),
        ),
        (
            "look-ahead".to_owned(),
            results.aggregation.name().to_owned(),
        ),
    ];
    for (data_set, lag) in &config.lags {
        data.provenance.push((
            format!("label lag of {}", data_set.name()),
            format!("{} ms", lag.samples * 5),
        ));
    }
    data.notes = vec![
        "Labels of these recordings are cues: muscle activity follows a few tenths of a second later. Tables show both, labels as published and lag-compensated labels, moved by one constant a data set that is estimated on training subjects.".to_owned(),
        "Every recording is preceded by its own first half second, six times over, so that short recordings are judged from their first sample; the device itself stays silent until it has 3 s of contiguous EMG.".to_owned(),
    ];
    let device = evaluation
        .candidates
        .iter()
        .find(|candidate| candidate.name == INTEGER);
    if let Some(integer) = device.or(evaluation.candidates.first()) {
        let aggregation = integer.condition(evaluation.aggregation);
        let settings = aggregation.settings();
        let vocabulary = preset.vocabulary();
        // The recording with the most changes shows most.
        let changes =
            |labels: &[Option<_>]| labels.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if let Some(at) = (0..evaluation.trials.len())
            .max_by_key(|&at| changes(&evaluation.trials[at].lag_compensated))
        {
            let trial = &evaluation.trials[at];
            let labels = smooth(
                &integer.logits[at],
                trial.emg.len(),
                vocabulary.classes(),
                settings,
            )
            .map_err(EvaluationError::from)?;
            data.timelines.push(
                Timeline {
                    subject: trial.subject.clone(),
                    recording: trial.name.clone(),
                    emg: trial.emg.clone(),
                    truth: trial.lag_compensated.clone(),
                    emitted: labels.reference,
                    look_ahead_samples: match aggregation {
                        LookAhead::None => 0,
                        LookAhead::AllRows | LookAhead::SameInstant => LOOK_AHEAD,
                    },
                }
                .section(0..SHOWN),
            );
        }
        let counts = confusion(integer, &evaluation.trials, vocabulary, aggregation)?;
        data.confusion = Some(Confusion {
            names: counts.intents.iter().map(|&name| name.to_owned()).collect(),
            counts: counts
                .counts
                .iter()
                .map(|row| row[..vocabulary.classes()].to_vec())
                .collect(),
        });
        data.offsets_ms = offsets(integer, &evaluation.trials, vocabulary, aggregation)?
            .into_iter()
            .map(|samples| f64::from(samples) * 5.0)
            .collect();
    }
    super::write_html(&data, page)?;
    if let Some(timeline) = data.timelines.first() {
        let picture = timeline_svg(timeline)?;
        write_whole(&page.with_file_name("timeline.svg"), picture.as_bytes())?;
    }
    Ok(())
}

/// Samples of the recording in the picture: 20 s.
const SHOWN: usize = 4000;

fn data_sets(config: &ResolvedConfig) -> String {
    config
        .lags
        .keys()
        .map(|data_set| data_set.name())
        .collect::<Vec<_>>()
        .join(", ")
}

/// Learning curves of whatever was trained in the folder.
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
