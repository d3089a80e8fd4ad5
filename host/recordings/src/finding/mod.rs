//! What the examiner finds in a recording: in words, with what to do.

mod advice;
mod groups;
mod scale;

use std::path::PathBuf;

use serde::Serialize;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ, Sample, WINDOW};

pub use groups::{Group, grouped};
pub use scale::Scale;

/// How bad a finding is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Good to know.
    Note,
    /// Usable; better without.
    Warning,
    /// Not good enough.
    Serious,
}

impl Severity {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Serious => "serious",
        }
    }
}

/// Something that is not as it should be in a recording. Channels count from 1, rows of samples from 1.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Finding {
    /// A limit that the reader of the data set knows of.
    #[error("{0}")]
    Known(String),
    /// Fewer samples than a window.
    #[error("{samples} samples: a label needs {WINDOW} and the model's look-ahead")]
    Short {
        /// Samples of the recording.
        samples: usize,
    },
    /// Values that are no counts.
    #[error(
        "expected the armband's counts, whole numbers from -128 to 127; found values from {least} to {most}: {}",
        scale.words()
    )]
    Scale {
        /// What they are.
        scale: Scale,
        /// The least of them.
        least: f64,
        /// The largest.
        most: f64,
    },
    /// All samples are the same.
    #[error("expected samples that change, found {sample:?} throughout")]
    Constant {
        /// The sample.
        sample: Sample,
    },
    /// No value below zero, or none above.
    #[error(
        "expected EMG around zero, found values on one side only: rectified, or its envelope (EMG mode 1)"
    )]
    OneSided,
    /// Most values at the ends of the range.
    #[error("expected EMG, found {percent:.0} % of all values at -128 or 127")]
    Clipped {
        /// Share of the values.
        percent: f64,
    },
    /// Too few channels have a signal of their own.
    #[error("expected {CHANNELS} channels, found {own} with a signal of their own")]
    FewChannels {
        /// Channels that are neither silent nor copies.
        own: usize,
    },
    /// A channel says nothing.
    #[error("channel {channel} is silent")]
    Dead {
        /// The channel.
        channel: usize,
    },
    /// A channel is a copy.
    #[error("channel {channel} says the same as channel {of}")]
    SameChannel {
        /// The copy.
        channel: usize,
        /// The channel that it equals.
        of: usize,
    },
    /// A channel is at the ends of its range.
    #[error("channel {channel} is saturated in {percent:.0} % of the samples")]
    Saturated {
        /// The channel.
        channel: usize,
        /// Share of its samples.
        percent: f64,
    },
    /// The mains are in the signal.
    #[error(
        "mains hum: up to {percent:.0} % of a channel's power is at {hz} Hz, in {} of {CHANNELS} channels",
        channels.len()
    )]
    Hum {
        /// Frequency of the mains.
        hz: usize,
        /// Channels that have it, from 0.
        channels: Vec<usize>,
        /// The worst channel's share.
        percent: f64,
    },
    /// The clock says another rate.
    #[error("expected {SAMPLE_RATE_HZ} rows a second, found {hz:.0} by column \"{column}\"")]
    Rate {
        /// The clock's column.
        column: String,
        /// Rows a second.
        hz: f64,
    },
    /// The clock leaps.
    #[error(
        "column \"{column}\" leaps {gaps} times, by {seconds:.2} s at row {row}: read as {pieces} recordings"
    )]
    Gap {
        /// The clock's column.
        column: String,
        /// Number of leaps.
        gaps: usize,
        /// Row behind the largest.
        row: usize,
        /// The largest; negative: the times go back.
        seconds: f64,
        /// Recordings that the rows are read as.
        pieces: usize,
    },
    /// The clock is not understood.
    #[error(
        "column \"{column}\" is not used: its values are no times, do not rise, or have no known unit"
    )]
    ClockUnclear {
        /// The clock's column.
        column: String,
    },
    /// Repeats of an even polling were left out.
    #[error(
        "each sample is there {times:.2} times, evenly: polled faster than {SAMPLE_RATE_HZ} Hz; {dropped} repeats are left out"
    )]
    Polled {
        /// Rows a sample.
        times: f64,
        /// Rows left out.
        dropped: usize,
    },
    /// Even repeats, of samples that are not at 200 Hz.
    #[error(
        "each row is there {times:.2} times, and what is left without repeats is not at {SAMPLE_RATE_HZ} Hz: samples are missing"
    )]
    Held {
        /// Rows a sample.
        times: f64,
    },
    /// Uneven repeats.
    #[error(
        "{percent:.0} % of the rows repeat the one before in no pattern: as many samples may be lost"
    )]
    Repeats {
        /// Share of the rows.
        percent: f64,
    },
    /// The same row for long.
    #[error("the samples stand still for {seconds:.1} s from row {row} on")]
    Standstill {
        /// The first row.
        row: usize,
        /// How long.
        seconds: f64,
    },
    /// Neighbours are not 5 ms apart.
    #[error(
        "samples hardly correlate with the next ({correlation:.2}; -0.2 to -0.4 at {SAMPLE_RATE_HZ} Hz): every second one may be missing"
    )]
    Unrelated {
        /// The correlation.
        correlation: f64,
    },
    /// Rows of several armbands.
    #[error("expected the rows of one armband, found those of {} in column \"{column}\": {}", devices.len(), devices.join(", "))]
    Devices {
        /// The column.
        column: String,
        /// Its values.
        devices: Vec<String>,
    },
    /// Columns of several armbands.
    #[error("expected {CHANNELS} columns of EMG, found those of {} armbands: {}", armbands.len(), armbands.join("; "))]
    ManyColumns {
        /// First and last column of each.
        armbands: Vec<String>,
    },
    /// Rows of sixteen values.
    #[error("expected {CHANNELS} channels, found {columns} columns: those of two armbands")]
    ManyChannels {
        /// Columns.
        columns: usize,
    },
    /// Rows of two armbands in turn.
    #[error("expected the samples of one armband, found two in turn, {rows} of each")]
    InTurn {
        /// Rows of one before the other's.
        rows: usize,
    },
    /// The samples are another recording's too.
    #[error(
        "the same samples as in {}{}{}, left out",
        of.display(),
        if *labels { ", with other labels" } else { "" },
        if *person { ", under another person's name" } else { "" }
    )]
    Copy {
        /// The recording that is kept.
        of: PathBuf,
        /// The labels differ.
        labels: bool,
        /// The persons differ.
        person: bool,
    },
    /// Some of the samples are another recording's too.
    #[error("{seconds:.0} s of its samples are also in {}", of.display())]
    Overlap {
        /// The other recording, or itself.
        of: PathBuf,
        /// How many.
        seconds: f64,
    },
}
