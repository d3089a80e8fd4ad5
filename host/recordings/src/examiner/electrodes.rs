//! Judgement of electrodes: silent, saturated and copied channels.

use shared::units::{CHANNELS, Sample};

use super::hum::{self, Hum};
use super::signal::Signal;
use crate::examiner::clock::rises_evenly;
use crate::examiner::finding::Finding;

/// Share of a channel's samples at -128 or 127 above which it is reported as saturated.
pub const SATURATED: f64 = 0.02;
/// Share of all samples at the ends of the range above which a recording is refused; the loudest public recording has
/// 0.05.
const CLIPPED: f64 = 0.5;
/// Amplitude in counts below which an electrode is silent; the quietest one of a public recording has 0.66.
pub const SILENT: f64 = 0.3;
/// Correlation above which a channel is a copy of another; neighbours reach 0.989 in public recordings.
const COPY: f64 = 0.995;
/// Minimum number of channels with a signal of their own in a recording.
const FEWEST: usize = 3;
/// Hum, in percent of a channel's power, above which correlated channels are no copies.
const ALIKE_BY_HUM: f64 = 50.0;

/// Advice on channels without a signal of their own.
const STREAMS: &str = "check that the armband streams, and that the columns are the EMG channels";

/// Share of the samples at either end of the range, by channel.
pub fn saturation(samples: &[Sample]) -> [f64; CHANNELS] {
    let mut ends = [0usize; CHANNELS];
    for sample in samples {
        for (count, &value) in ends.iter_mut().zip(sample) {
            *count += usize::from(value == i8::MIN || value == i8::MAX);
        }
    }
    ends.map(|count| count as f64 / samples.len().max(1) as f64)
}

/// Mean distance of each channel from its own mean, in counts.
pub fn levels(samples: &[Sample]) -> [f64; CHANNELS] {
    Signal::of(samples).levels
}

shared::names! {
    /// Fault of an electrode.
    pub enum Fault {
        /// Less signal than the noise of an electrode on skin.
        Silent = "silent",
        /// Values at the ends of the range.
        Clipped = "clipped",
        /// Mains hum.
        Hum = "hum",
    }
}

/// Fault of each electrode in some seconds of a stream.
pub fn faults(samples: &[Sample]) -> [Option<Fault>; CHANNELS] {
    let (levels, saturation) = (levels(samples), saturation(samples));
    let hums = hum::find(samples).map_or(Vec::new(), |hum| hum.channels);
    std::array::from_fn(|channel| {
        if levels[channel] < SILENT {
            Some(Fault::Silent)
        } else if saturation[channel] > SATURATED {
            Some(Fault::Clipped)
        } else {
            hums.contains(&channel).then_some(Fault::Hum)
        }
    })
}

/// Judges the electrodes; the error is a finding that makes the recording meaningless.
pub(super) fn examine(signal: &Signal<'_>, hum: Option<&Hum>) -> Result<Vec<Finding>, Finding> {
    if signal.levels.iter().all(|&level| level == 0.0) {
        let what = format!(
            "expected samples that change, found {:?} throughout",
            signal.samples[0]
        );
        return Err(Finding::warning("constant", what, STREAMS));
    }
    let values = || signal.samples.iter().flatten();
    if values().all(|&value| value >= 0) || values().all(|&value| value <= 0) {
        return Err(Finding::warning(
            "one-sided",
            "expected EMG around zero, found values on one side only: rectified, or its envelope (EMG mode 1)",
            "record in EMG mode 2 (filtered, not rectified) at 200 Hz",
        ));
    }
    let values = |channel: usize| -> Vec<f64> {
        let samples = signal.samples.iter();
        samples.map(|sample| f64::from(sample[channel])).collect()
    };
    if let Some(channel) = (0..CHANNELS).find(|&channel| rises_evenly(&values(channel))) {
        let channel = channel + 1;
        return Err(Finding::warning(
            "counter",
            format!(
                "expected EMG in each channel, found a column that counts in channel {channel}"
            ),
            "take the eight columns beside it for the channels",
        ));
    }
    let saturation = saturation(signal.samples);
    let all = saturation.iter().sum::<f64>() / CHANNELS as f64;
    if all > CLIPPED {
        let percent = 100.0 * all;
        return Err(Finding::warning(
            "clipped",
            format!("expected EMG, found {percent:.0} % of all values at -128 or 127"),
            "check the scale: counts from -128 to 127",
        ));
    }
    let alike = hum.is_some_and(|hum| hum.percent > ALIKE_BY_HUM);
    let all: Vec<usize> = (0..CHANNELS).collect();
    let (dead, alive) = all
        .into_iter()
        .partition::<Vec<_>, _>(|&channel| signal.levels[channel] < SILENT);
    let (mut own, mut copies): (Vec<usize>, Vec<String>) = (Vec::new(), Vec::new());
    for &channel in &alive {
        let same = |&&other: &&usize| {
            let mut samples = signal.samples.iter();
            samples.all(|sample| sample[channel] == sample[other])
                || (!alike && signal.correlation(channel, other).abs() > COPY)
        };
        match own.iter().find(same) {
            Some(&of) => copies.push(format!("{} as {}", channel + 1, of + 1)),
            None => own.push(channel),
        }
    }
    if own.len() < FEWEST {
        let what = format!(
            "expected {CHANNELS} channels, found {} with a signal of their own",
            own.len()
        );
        return Err(Finding::warning("few-channels", what, STREAMS));
    }
    let saturated = alive
        .into_iter()
        .filter(|&channel| saturation[channel] > SATURATED);
    let saturated: Vec<usize> = saturated.collect();
    let most = saturated.iter().map(|&channel| saturation[channel]);
    let percent = 100.0 * most.fold(0.0, f64::max);
    let mut findings = Vec::new();
    if !dead.is_empty() {
        findings.push(Finding::warning(
            "silent-channel",
            format!("{} silent", are(&dead)),
            "press the electrode against the skin, wipe skin and electrode; if it stays silent, it is broken",
        ));
    }
    if !copies.is_empty() {
        findings.push(Finding::warning(
            "same-channel",
            format!("channels equal others: {}", copies.join(", ")),
            "check how the columns were written",
        ));
    }
    if !saturated.is_empty() {
        findings.push(Finding::warning(
            "saturated-channel",
            format!(
                "{} saturated in up to {percent:.0} % of the samples",
                are(&saturated)
            ),
            "less force, or move the armband a little",
        ));
    }
    Ok(findings)
}

/// Channels, given from 0, in words: `channels 2, 4 to 6 and 8 are`.
fn are(channels: &[usize]) -> String {
    let number = |channel: &usize| (channel + 1).to_string();
    if let [only] = channels {
        return format!("channel {} is", number(only));
    }
    let mut parts: Vec<String> = Vec::new();
    for run in channels.chunk_by(|a, b| a + 1 == *b) {
        match run {
            [first, _, .., last] => parts.push(format!("{} to {}", number(first), number(last))),
            few => parts.extend(few.iter().map(number)),
        }
    }
    let last = parts.pop().unwrap_or_default();
    match &parts[..] {
        [] => format!("channels {last} are"),
        before => format!("channels {} and {last} are", before.join(", ")),
    }
}
