//! `myointent quickstart`: from recordings to a judged model file in one go.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use shared::units::LOOK_AHEAD;

use super::arguments::{BackendArguments, Begun, DataArguments, recordings};
use super::table::tables;
use crate::evaluation::judge::{LookAhead, confusion, offsets};
use crate::evaluation::track::track;
use crate::training::fit::EpochMetrics;
use crate::execution::interrupt::Interrupt;
use crate::run::plan::Plan;
use crate::run::preset::Preset;
use crate::execution::progress;
use crate::report::{self, Confusion, Curve, Panel, ReportData, Timeline};
use crate::execution::run_folder::{RunError, RunFolder, write_whole};
use crate::run::stage::{INTEGER, Judged, Results, Stage};

/// Name of the model file in a run folder.
pub const MODEL: &str = "student.intent";

/// Where recordings are looked for when none are given.
const USUAL_PLACES: [&str; 2] = ["data", "../shared/data"];

/// Arguments of `quickstart`.
#[derive(Debug, Args)]
#[command(
    after_help = "Recordings are taken from --data, else MYOINTENT_DATA, else ./data or ../shared/data; without any,\n\
    synthetic ones are made. The output says which, and who was left out."
)]
pub struct Arguments {
    /// Folder for checkpoints, metrics, model file and report.
    #[arg(long, value_name = "DIR", default_value = "runs/quickstart")]
    run: PathBuf,
    /// Built-in preset or a TOML file.
    #[arg(long, default_value = "quickstart")]
    preset: String,
    /// Seed of everything drawn, instead of the preset's.
    #[arg(long)]
    seed: Option<u64>,
    /// Go on where an interrupted quickstart of this run folder stopped.
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Trains, distils, quantizes, judges and reports.
///
/// # Errors
/// When recordings, preset or folder cannot be used.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let interrupt = Interrupt::listen();
    let mut preset = Preset::find(&arguments.preset)?;
    preset.seed = arguments.seed.unwrap_or(preset.seed);
    // Damage in recordings that the user did not choose must not stop a first try; it is told.
    let found = USUAL_PLACES
        .iter()
        .map(Path::new)
        .find(|place| place.is_dir());
    let given = arguments.data.data.as_deref();
    let skip_bad = arguments.data.skip_bad || given.is_none();
    let data = given.or(found);
    let library = recordings(data, skip_bad, preset.seed)?;

    let folder = RunFolder::open(&arguments.run)?;
    let plan = if arguments.resume {
        Plan::load(&folder)?
    } else {
        Plan::new(preset, &library, data, skip_bad, None)?
    };
    let run = Begun::begin(folder, plan, library)?;
    let plan = &run.plan;
    progress::say(&format!(
        "training on {} subjects: {}",
        plan.split.training.len(),
        plan.split.training.join(", ")
    ));
    progress::say(&format!(
        "left out, never trained on: {}",
        plan.split.held_out.join(", ")
    ));
    for (data_set, lag) in &plan.lags {
        progress::say(&format!(
            "labels of {} are moved by {} ms",
            data_set.name(),
            lag.samples * 5
        ));
    }

    let stage = run.stage(&arguments.backend, arguments.resume, &interrupt);
    stage.train()?;
    stage.distill()?;
    let model = run.folder.file(MODEL);
    let bytes = stage.quantize(&model)?;
    let (results, judged) = stage.evaluate(Some(&bytes))?;
    // Once more, now that there are measurements to put beside the weights.
    let bytes = stage.quantize(&model)?;
    let page = run.folder.file("report.html");
    report(&stage, &results, &judged, &page)?;

    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "recordings: {}",
        data.map_or_else(|| "synthetic".to_owned(), |path| path.display().to_string())
    )?;
    writeln!(out, "left out:   {}\n", results.held_out.join(", "))?;
    for table in tables(&results) {
        writeln!(out, "{}", table.plain())?;
    }
    writeln!(
        out,
        "model file: {} ({} bytes)",
        model.display(),
        bytes.len()
    )?;
    writeln!(out, "report:     {}", page.display())?;
    Ok(())
}

/// Writes the page that shows what a run's models do.
///
/// # Errors
/// When the page cannot be written.
pub fn report(
    stage: &Stage<'_>,
    results: &Results,
    judged: &Judged,
    page: &Path,
) -> anyhow::Result<()> {
    let (plan, preset) = (stage.plan, &stage.plan.preset);
    let mut data = ReportData {
        title: format!("Intent from muscles alone: preset {}", preset.name),
        summary: format!(
            "Trained on {} people, judged on {} people none of the models has seen.",
            plan.split.training.len(),
            plan.split.held_out.len()
        ),
        tables: tables(results),
        panels: panels(stage.run)?,
        ..ReportData::default()
    };
    data.provenance = vec![
        (
            "recordings".to_owned(),
            plan.data
                .as_ref()
                .map_or_else(|| "synthetic".to_owned(), |_| data_sets(plan)),
        ),
        ("left out".to_owned(), plan.split.held_out.join(", ")),
        (
            "chose the checkpoint".to_owned(),
            plan.split.validation.join(", "),
        ),
        ("seed".to_owned(), preset.seed.to_string()),
        (
            "revision".to_owned(),
            plan.git_revision
                .clone()
                .unwrap_or_else(|| "unknown".to_owned()),
        ),
        ("look-ahead".to_owned(), results.reading.name().to_owned()),
    ];
    for (data_set, lag) in &plan.lags {
        data.provenance.push((
            format!("label lag of {}", data_set.name()),
            format!("{} ms", lag.samples * 5),
        ));
    }
    data.notes = vec![
        "Labels of these recordings are cues: muscles follow a few tenths of a second later. Tables show both, labels as published and labels moved by one constant a data set, estimated on training subjects.".to_owned(),
        "Every recording is preceded by its own first half second, six times over, so that short recordings are judged from their first sample; the device itself stays silent until it has 3 s of contiguous EMG.".to_owned(),
    ];
    let device = judged
        .candidates
        .iter()
        .find(|candidate| candidate.name == INTEGER);
    if let Some(integer) = device.or(judged.candidates.first()) {
        let reading = integer.condition(judged.reading);
        let settings = reading.settings();
        let vocabulary = preset.vocabulary();
        // The recording with the most changes shows most.
        let changes =
            |labels: &[Option<_>]| labels.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if let Some(at) =
            (0..judged.trials.len()).max_by_key(|&at| changes(&judged.trials[at].moved))
        {
            let trial = &judged.trials[at];
            let track = track(
                &integer.rows[at],
                trial.emg.len(),
                vocabulary.classes(),
                settings,
            )?;
            data.timelines.push(
                Timeline {
                    subject: trial.subject.clone(),
                    recording: trial.name.clone(),
                    emg: trial.emg.clone(),
                    truth: trial.moved.clone(),
                    emitted: track.spoken,
                    look_ahead_samples: match reading {
                        LookAhead::None => 0,
                        LookAhead::AllRows | LookAhead::SameInstant => LOOK_AHEAD,
                    },
                }
                .section(0..SHOWN),
            );
        }
        let counts = confusion(integer, &judged.trials, vocabulary, reading)?;
        data.confusion = Some(Confusion {
            names: counts.intents.iter().map(|&name| name.to_owned()).collect(),
            counts: counts
                .counts
                .iter()
                .map(|row| row[..vocabulary.classes()].to_vec())
                .collect(),
        });
        data.offsets_ms = offsets(integer, &judged.trials, vocabulary, reading)?
            .into_iter()
            .map(|samples| f64::from(samples) * 5.0)
            .collect();
    }
    report::write_html(&data, page)?;
    if let Some(timeline) = data.timelines.first() {
        let picture = report::timeline_svg(timeline)?;
        write_whole(&page.with_file_name("timeline.svg"), picture.as_bytes())?;
    }
    Ok(())
}

/// Samples of the recording in the picture: 20 s.
const SHOWN: usize = 4000;

fn data_sets(plan: &Plan) -> String {
    plan.lags
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
