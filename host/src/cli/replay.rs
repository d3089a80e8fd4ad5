//! `myointent replay`: one recording through the device's own pipeline.

use std::io::{BufWriter, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, bail};
use clap::Args;
use shared::calibration::Memory;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::model::head::Head;
use shared::stream::alignment::Arm;
use shared::uart_line::line::Line;
use shared::uart_line::{Report, ReportKind};
use shared::units::{CHANNELS, SAMPLE_RATE_HZ, Sample, WINDOW};

use crate::cli::arguments::{AS_RECORDED, log_doubts, mirrored};
use crate::cli::read_model;
use evaluation::inference::Stream;
use recordings::{LoadOptions, Recording, load};

/// Cause of a line that stands for a label.
const LOCKED: &str = ",locked";

/// Arguments of `replay`.
#[derive(Debug, Args)]
#[command(
    after_help = "The device's clock starts with the first sample; samples arrive two at a time, every 10 ms.\n\
    Lines are the device's, byte for byte; docs/uart.md explains them.\n\n\
    Examples:\n  myointent replay models/three-class.intent recordings/s1/s1_grasp.csv\n  \
    myointent replay models/three-class.intent recordings --name own/s1/s1_grasp --speed\n  \
    myointent replay models/three-class.intent recordings/s1/s1_grasp.csv --align\n  \
    myointent replay models/three-class.intent recordings/s1/s1_dinner.csv --lock\n  \
    myointent replay models/three-class.intent recordings/s1/s1_cues.csv --calibrate 5"
)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// A recording: any format that `data inspect` reads, one recording in it.
    #[arg(value_name = "RECORDING")]
    recording: PathBuf,
    /// Recording to replay, if the path holds several, as `data inspect` prints it: data-set/person/name.
    #[arg(long)]
    name: Option<String>,
    #[arg(hide_short_help = true, long, help = AS_RECORDED)]
    as_recorded: bool,
    /// Begin an alignment with the first sample: the wearer opens the hand twice, with rest before and after.
    #[arg(long, conflicts_with = "speed")]
    align: bool,
    /// Tell the alignment whether the armband is on the other arm than in training, 0 or 1, instead of having it found.
    #[arg(long, value_name = "0|1", requires = "align", value_parser = mirrored)]
    mirrored: Option<Arm>,
    /// Begin a calibration after so many seconds, as a board does when asked: the wearer follows its cues, each 4 s. For labelled
    /// holds, `calibrate` first and replay the new file.
    #[arg(long, value_name = "SECONDS", conflicts_with_all = ["speed", "align"])]
    calibrate: Option<u32>,
    /// Show the calibration other movement too, 6 s.
    #[arg(long, requires = "calibrate")]
    show_others: bool,
    /// Lock the labels from the first one on, as a board with a lock does: an open hand that is held unlocks them.
    #[arg(long, conflicts_with = "speed")]
    lock: bool,
    /// Write the strength of the contraction behind each label, as a board does after STRENGTH,on.
    #[arg(long, conflicts_with = "speed")]
    strength: bool,
    /// Print how many times faster than real time the pipeline runs, instead of the lines.
    #[arg(long)]
    speed: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    let bytes = read_model(path)?;
    let model = Model::parse(&bytes).with_context(|| format!("{} is refused", path.display()))?;
    let recording = recording_of(
        &arguments.recording,
        arguments.name.as_deref(),
        arguments.as_recorded,
    )?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    if arguments.speed {
        let start = Instant::now();
        let mut lines = 0_usize;
        replay(&model, &recording.samples, Start::default(), |_| {
            lines += 1;
            Ok(())
        })?;
        let taken = start.elapsed().as_secs_f64();
        writeln!(
            out,
            "{:.0} x real time: {:.1} s of EMG in {taken:.4} s, {lines} lines",
            recording.seconds() / taken,
            recording.seconds(),
        )?;
        return Ok(());
    }
    let arm = arguments.mirrored.unwrap_or_default();
    let start = Start {
        align: arguments.align.then_some(arm),
        lock: arguments.lock,
        strength: arguments.strength,
        calibrate: arguments.calibrate.map(|seconds| Lesson {
            at: u64::from(seconds) * u64::from(SAMPLE_RATE_HZ),
            others: arguments.show_others,
        }),
    };
    let mut labels = 0_usize;
    replay(&model, &recording.samples, start, |line| {
        labels += usize::from(line.starts_with("$LABEL") || line.contains(LOCKED));
        out.write_all(line.as_bytes())
    })?;
    out.flush()?;
    if labels == 0 {
        bail!(
            "no label: the first needs {}, a window of {WINDOW} and the model's look-ahead; {} has {}",
            first_label(&model)?,
            recording.full_name(),
            recording.samples.len()
        );
    }
    Ok(())
}

/// Number of samples before the first label of a model, found by running the pipeline on silence.
fn first_label(model: &Model<'_>) -> anyhow::Result<String> {
    let mut first = None;
    let silence = vec![[0; CHANNELS]; 2 * WINDOW];
    replay(model, &silence, Start::default(), |line| {
        let report = Report::parse(line.as_bytes()).ok();
        let label = report.filter(|report| report.kind == ReportKind::Label);
        first = first.or(label.map(|label| label.emitted.0));
        Ok(())
    })?;
    Ok(first.map_or_else(
        || format!("more than {} samples", 2 * WINDOW),
        |newest| format!("{} samples", newest + 1),
    ))
}

/// UART lines of a model over samples.
pub fn lines(model: &[u8], samples: &[Sample]) -> anyhow::Result<String> {
    lines_from(model, samples, Start::default())
}

/// UART lines of a model over samples, with a calibration that begins after so many of them.
pub fn calibrated_lines(model: &[u8], samples: &[Sample], at: u64) -> anyhow::Result<String> {
    let start = Start {
        calibrate: Some(Lesson { at, others: false }),
        ..Start::default()
    };
    lines_from(model, samples, start)
}

fn lines_from(model: &[u8], samples: &[Sample], start: Start) -> anyhow::Result<String> {
    let model = Model::parse(model)?;
    let mut lines = String::new();
    replay(&model, samples, start, |line| {
        lines.push_str(line);
        Ok(())
    })?;
    Ok(lines)
}

#[derive(Clone, Copy, Default)]
struct Start {
    /// Arm of an alignment that begins with the first sample.
    align: Option<Arm>,
    lock: bool,
    strength: bool,
    calibrate: Option<Lesson>,
}

#[derive(Clone, Copy)]
struct Lesson {
    /// Samples before it.
    at: u64,
    others: bool,
}

/// Runs the device's pipeline over samples.
fn replay(
    model: &Model<'_>,
    samples: &[Sample],
    start: Start,
    mut output: impl FnMut(&str) -> std::io::Result<()>,
) -> anyhow::Result<()> {
    let encoder = HostEncoder::new(model)?;
    let (mut state, mut memory) = (encoder.fresh(), (Memory::EMPTY, Head::EMPTY));
    let mut stream = Stream::new(model, encoder, &mut state, start.align)?;
    if start.lock {
        stream.lock();
    }
    if let Some(Lesson { at, others }) = start.calibrate {
        stream.calibrate(model, at, others, &mut memory)?;
    }
    let written = stream.push(
        samples,
        |_| (),
        |line| {
            let line = match line {
                Line::Report(report) if !start.strength => Line::Report(report.without_strength()),
                line => line,
            };
            match output(&line.to_string()) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => ControlFlow::Break(error),
            }
        },
    );
    match written {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(error) => Err(error.into()),
    }
}

/// Loads the recording at a path, by name if there are several, in the common frame or with the channels as recorded.
pub fn recording_of(
    path: &Path,
    name: Option<&str>,
    as_recorded: bool,
) -> anyhow::Result<Recording> {
    let options = LoadOptions {
        as_recorded,
        ..LoadOptions::default()
    };
    let mut library = load(path, &options)?;
    if let Some(name) = name {
        library
            .recordings
            .retain(|recording| recording.full_name() == name);
    }
    log_doubts(&library);
    match library.recordings.len() {
        0 if name.is_none() && !library.skipped.is_empty() => {
            Err(library.skipped.swap_remove(0).into())
        }
        0 => bail!(
            "{}: found no recording{}",
            path.display(),
            name.map(|name| format!(" {name}")).unwrap_or_default()
        ),
        1 => Ok(library.recordings.remove(0)),
        several => {
            let first = library.recordings[0].full_name();
            bail!(
                "{}: expected one recording, found {several}: give one file, or choose with --name {first}",
                path.display()
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::library::inspection::Inspection;
    use shared::model::file::random::{SMALL, random_model};
    use shared::stream::strength::Percent;
    use shared::uart_line::alignment::AlignmentState;

    fn lines(bytes: &[u8], samples: &[Sample], start: Start) -> Vec<String> {
        let lines = lines_from(bytes, samples, start).unwrap();
        lines.split_inclusive('\n').map(str::to_owned).collect()
    }

    /// Lines of 4.5 s of the shipped model.
    fn shipped(start: Start) -> Vec<String> {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/three-class.intent");
        lines(&std::fs::read(file).unwrap(), &[[1; CHANNELS]; 900], start)
    }

    #[test]
    fn an_alignment_is_reported_from_the_first_line_on() {
        let mut parts = random_model(SMALL, 1);
        let mut begun = |template| {
            parts.template = template;
            let start = Start {
                align: Some(Arm::Unknown),
                ..Start::default()
            };
            let lines = lines(&parts.to_bytes().unwrap(), &[[0; 8]; 4], start);
            let Ok(Line::Alignment(report)) = Line::parse(lines[1].as_bytes()) else {
                panic!("{}", lines[1]);
            };
            assert_eq!((lines.len(), report.sequence), (2, 1));
            report.state
        };
        let template = random_model(SMALL, 1).template;
        assert_eq!(begun(template), AlignmentState::Waiting);
        assert_eq!(begun(None), AlignmentState::Unavailable);
    }

    #[test]
    fn lines_have_the_strength_on_request_and_are_else_the_same() {
        let reports = |strength| {
            let lines = shipped(Start {
                strength,
                ..Start::default()
            });
            let reports = lines.iter().map(|line| Report::parse(line.as_bytes()));
            reports.collect::<Result<Vec<_>, _>>().unwrap()
        };
        let (plain, strong) = (reports(false), reports(true));
        let zero = Some(Percent::ZERO);
        assert!(strong.iter().all(|report| report.strength == zero));
        let stripped = strong.into_iter().map(Report::without_strength);
        assert_eq!(stripped.collect::<Vec<_>>(), plain);
    }

    #[test]
    fn name_takes_what_inspect_prints() {
        let folder = tempfile::tempdir().unwrap();
        let text = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n0,1,2,3,4,5,6,7,8\n";
        std::fs::create_dir(folder.path().join("s1")).unwrap();
        for file in ["s1/s1_a.csv", "s1/s1_b.csv"] {
            std::fs::write(folder.path().join(file), text).unwrap();
        }
        let library = load(folder.path(), &LoadOptions::default()).unwrap();
        let inspection = Inspection::new(&library);
        let mut findings = inspection.findings.iter();
        let short = findings.find(|group| group.finding.kind == "short");
        let printed = &short.unwrap().which[1];
        let found = recording_of(folder.path(), Some(printed), false).unwrap();
        assert_eq!(found.name, "s1_b");
        let error = recording_of(folder.path(), None, false);
        let error = error.unwrap_err().to_string();
        assert!(error.contains("--name own/s1/s1_a"), "{error}");
    }
}
