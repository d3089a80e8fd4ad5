//! Findings of the examiner in a recording, with text and advice.

mod advice;
mod groups;

use std::path::PathBuf;

use serde::Serialize;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ, Sample, WINDOW};

pub use groups::{Group, grouped};

shared::names! {
    /// Severity of a finding.
    #[derive(PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Severity {
        /// Information only.
        Note = "note",
        /// The recording is usable, but has a defect.
        Warning = "warning",
        /// Results on the recording are unreliable.
        Serious = "serious",
    }
}

/// Scale of values that should be counts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Scale {
    /// Whole multiples of the value of one count.
    Step {
        step: f64,
        known: Option<&'static str>,
    },
    /// Bytes without a sign, 0 to 255: those above 127 are negative counts.
    Unsigned,
    /// Bytes with 128 added, 0 to 255.
    Offset,
    /// Values that are multiples of no step.
    Unknown,
}

impl Scale {
    /// Description of the values.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Step {
                known: Some(known), ..
            } => known.to_owned(),
            Self::Step { step, known: None } => format!("whole multiples of {step}"),
            Self::Unsigned => "bytes without a sign".to_owned(),
            Self::Offset => "bytes with 128 added".to_owned(),
            Self::Unknown => "filtered, normalized, or of another device".to_owned(),
        }
    }

    /// Advice on converting the values to counts.
    pub(crate) fn advice(self) -> String {
        match self {
            Self::Step { step, .. } if step < 1.0 => {
                format!("multiply by {} and round", (1.0 / step).round())
            }
            Self::Step { step, .. } => format!("divide by {step}"),
            Self::Unsigned => "subtract 256 from each value above 127".to_owned(),
            Self::Offset => "subtract 128 from each value".to_owned(),
            Self::Unknown => "export the armband's own samples, as they came".to_owned(),
        }
    }
}

/// Defect of a recording. Channels and rows count from 1, but the channels of [`Hum`](Self::Hum) from 0.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Finding {
    #[error("{0}")]
    Known(String),
    #[error("{samples} samples: a label needs {WINDOW} and the model's look-ahead")]
    Short { samples: usize },
    #[error(
        "expected the armband's counts, whole numbers from -128 to 127; found values from {least} to {most}: {}",
        scale.words()
    )]
    Scale { scale: Scale, least: f64, most: f64 },
    #[error("expected samples that change, found {sample:?} throughout")]
    Constant { sample: Sample },
    #[error(
        "expected EMG around zero, found values on one side only: rectified, or its envelope (EMG mode 1)"
    )]
    OneSided,
    #[error("expected EMG in each channel, found a column that counts in channel {channel}")]
    Counter { channel: usize },
    #[error("expected EMG, found {percent:.0} % of all values at -128 or 127")]
    Clipped { percent: f64 },
    #[error("expected {CHANNELS} channels, found {own} with a signal of their own")]
    FewChannels { own: usize },
    #[error("{} silent", are(channels))]
    Dead { channels: Vec<usize> },
    #[error("channels equal others: {}", pairs.iter().map(|(own, of)| format!("{own} as {of}")).collect::<Vec<_>>().join(", "))]
    SameChannel { pairs: Vec<(usize, usize)> },
    #[error("{} saturated in up to {percent:.0} % of the samples", are(channels))]
    Saturated { channels: Vec<usize>, percent: f64 },
    #[error(
        "mains hum: up to {percent:.0} % of a channel's power is at {hz} Hz, in {} of {CHANNELS} channels",
        channels.len()
    )]
    Hum {
        hz: usize,
        channels: Vec<usize>,
        percent: f64,
    },
    #[error("expected {SAMPLE_RATE_HZ} rows a second, found {hz:.0} by column \"{column}\"")]
    Rate { column: String, hz: f64 },
    #[error(
        "column \"{column}\" leaps {gaps} times, by {seconds:.2} s at row {row}: read as {pieces} recordings"
    )]
    Gap {
        column: String,
        gaps: usize,
        row: usize,
        seconds: f64,
        pieces: usize,
    },
    #[error(
        "column \"{column}\" is not used: its values are no times, do not rise, or have no known unit"
    )]
    ClockUnclear { column: String },
    #[error(
        "each sample is there {times:.2} times, evenly: polled faster than {SAMPLE_RATE_HZ} Hz; {dropped} repeats are left out"
    )]
    Polled { times: f64, dropped: usize },
    #[error(
        "each row is there {times:.2} times, and what is left without repeats is not at {SAMPLE_RATE_HZ} Hz: samples are missing"
    )]
    Held { times: f64 },
    #[error(
        "{percent:.0} % of the rows repeat the one before in no pattern: as many samples may be lost"
    )]
    Repeats { percent: f64 },
    #[error("the samples stand still for {seconds:.1} s from row {row} on")]
    Standstill { row: usize, seconds: f64 },
    #[error(
        "samples hardly correlate with the next ({correlation:.2}; -0.2 to -0.4 at {SAMPLE_RATE_HZ} Hz): every second one may be missing"
    )]
    Unrelated { correlation: f64 },
    #[error(
        "samples resemble the next (correlation {correlation:.2}; -0.2 to -0.4 at {SAMPLE_RATE_HZ} Hz): sampled faster than \
         {SAMPLE_RATE_HZ} Hz, filtered, or of another device"
    )]
    Resembling { correlation: f64 },
    #[error("expected the rows of one armband, found those of {} in column \"{column}\": {}", devices.len(), devices.join(", "))]
    Devices {
        column: String,
        devices: Vec<String>,
    },
    #[error("expected {CHANNELS} columns of EMG, found those of {} armbands: {}", armbands.len(), armbands.join("; "))]
    ManyColumns { armbands: Vec<String> },
    #[error("expected {CHANNELS} channels, found {columns} columns: those of two armbands")]
    ManyChannels { columns: usize },
    #[error(
        "expected a sample of {CHANNELS} channels a row, found {values} values: {} samples a row",
        values / CHANNELS
    )]
    Windows { values: usize },
    #[error("expected the samples of one armband, found two in turn, {rows} of each")]
    InTurn { rows: usize },
    #[error(
        "the same samples as in {}{}{}, left out",
        of.display(),
        if *labels { ", with other labels" } else { "" },
        if *person { ", under another person's name" } else { "" }
    )]
    Copy {
        of: PathBuf,
        labels: bool,
        person: bool,
    },
    #[error("{seconds:.0} s of its samples are also in {}", of.display())]
    Overlap { of: PathBuf, seconds: f64 },
}

/// Channels in words: `channels 2, 4 to 6 and 8 are`.
fn are(channels: &[usize]) -> String {
    if let [only] = channels {
        return format!("channel {only} is");
    }
    let mut parts: Vec<String> = Vec::new();
    for run in channels.chunk_by(|a, b| a + 1 == *b) {
        match run {
            [first, _, .., last] => parts.push(format!("{first} to {last}")),
            few => parts.extend(few.iter().map(usize::to_string)),
        }
    }
    let last = parts.pop().unwrap_or_default();
    match &parts[..] {
        [] => format!("channels {last} are"),
        before => format!("channels {} and {last} are", before.join(", ")),
    }
}
