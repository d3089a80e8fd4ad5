//! `myointent replay`: one recording through exactly the device's pipeline.

use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use clap::Args;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::pipeline::{Pipeline, Reports};
use shared::stream::safe_state::Start;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample};

use crate::dataset::LoadOptions;
use crate::dataset::Recording;
use crate::dataset::load;

/// Arguments of `replay`.
#[derive(Debug, Args)]
#[command(
    after_help = "The board's clock starts with the first sample; samples come two at a time, every 10 ms.\n\
    Lines are the device's, byte for byte: see the README for what they mean."
)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// A recording: any format that `data inspect` reads, one recording in it.
    #[arg(value_name = "RECORDING")]
    recording: PathBuf,
    /// Which recording, where the path holds several: subject/name as `data inspect` prints it.
    #[arg(long)]
    name: Option<String>,
    /// Let the recording take as long as it did.
    #[arg(long)]
    real_time: bool,
    /// Print no lines but how many times faster than real time the pipeline ran.
    #[arg(long, conflicts_with = "real_time")]
    speed: bool,
}

/// Replays a recording.
///
/// # Errors
/// When the model is refused or the recording cannot be read.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let model = Model::parse(&bytes).with_context(|| format!("{} is refused", path.display()))?;
    let recording = one_recording(&arguments.recording, arguments.name.as_deref())?;
    let pace = if arguments.real_time {
        Some(Instant::now())
    } else {
        None
    };
    let mut out = BufWriter::new(std::io::stdout().lock());
    if arguments.speed {
        let start = Instant::now();
        let mut lines = 0_usize;
        let task = Replay {
            settings: model.header.smoother.in_patches(),
            samples: &recording.samples,
            pace,
            emit: |_: &str| {
                lines += 1;
                Ok(())
            },
        };
        task.run(&model)?;
        let taken = start.elapsed().as_secs_f64();
        writeln!(
            out,
            "{:.0} x real time: {:.1} s of EMG in {:.4} s, {lines} lines",
            recording.seconds() / taken,
            recording.seconds(),
            taken
        )?;
        return Ok(());
    }
    let task = Replay {
        settings: model.header.smoother.in_patches(),
        samples: &recording.samples,
        pace,
        emit: |line: &str| {
            out.write_all(line.as_bytes())?;
            if pace.is_some() { out.flush() } else { Ok(()) }
        },
    };
    task.run(&model)?;
    out.flush()?;
    Ok(())
}

/// The lines of a whole recording.
///
/// # Errors
/// When the model is refused or the recording cannot be read.
pub fn lines(model: &[u8], recording: &std::path::Path) -> anyhow::Result<String> {
    lines_of(model, &one_recording(recording, None)?.samples)
}

/// The lines of samples.
///
/// # Errors
/// When the model is refused.
pub fn lines_of(model: &[u8], samples: &[Sample]) -> anyhow::Result<String> {
    let model = Model::parse(model)?;
    let mut lines = String::new();
    let task = Replay {
        settings: model.header.smoother.in_patches(),
        samples,
        pace: None,
        emit: |line: &str| {
            lines.push_str(line);
            Ok(())
        },
    };
    task.run(&model)?;
    Ok(lines)
}

/// The recording at a path, by name where there are several.
///
/// # Errors
/// When there is none, or several and no name.
pub fn one_recording(path: &std::path::Path, name: Option<&str>) -> anyhow::Result<Recording> {
    let mut library = load(path, &LoadOptions::default())?;
    let full = |recording: &Recording| format!("{}/{}", recording.subject, recording.name);
    if let Some(name) = name {
        library
            .recordings
            .retain(|recording| full(recording) == name);
    }
    match library.recordings.len() {
        0 => bail!(
            "{}: no recording{} found",
            path.display(),
            name.map(|name| format!(" {name}")).unwrap_or_default()
        ),
        1 => Ok(library.recordings.remove(0)),
        several => {
            let first = full(&library.recordings[0]);
            bail!(
                "{}: {several} recordings found, one expected: give one file, or --name such as {first}",
                path.display()
            )
        }
    }
}

struct Replay<'s, T> {
    settings: shared::stream::smoother::Settings,
    samples: &'s [Sample],
    pace: Option<Instant>,
    emit: T,
}

impl<T: FnMut(&str) -> std::io::Result<()>> Replay<'_, T> {
    fn run(mut self, model: &Model<'_>) -> anyhow::Result<()> {
        let encoder = HostEncoder::new(model)?;
        let mut state = encoder.fresh();
        let mut pipeline = Pipeline::new(encoder, &mut state, self.settings, Start::Boot)?;
        let first = pipeline.state_report();
        (self.emit)(&first.to_string())?;
        for (index, pair) in self.samples.chunks(2).enumerate() {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "a recording is shorter than 49 days"
            )]
            let now = Millis(index as u32 * 2 * SAMPLE_PERIOD_MS);
            if let Some(start) = self.pace {
                std::thread::sleep(
                    (start + Duration::from_millis(now.0.into()))
                        .saturating_duration_since(Instant::now()),
                );
            }
            for &sample in pair {
                self.report(pipeline.sample(now, sample))?;
            }
        }
        Ok(())
    }

    fn report(&mut self, reports: Reports) -> std::io::Result<()> {
        for report in reports {
            (self.emit)(&report.to_string())?;
        }
        Ok(())
    }
}
