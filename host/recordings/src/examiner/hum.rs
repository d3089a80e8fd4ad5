//! Mains hum: power at 50 or 60 Hz that the neighbouring frequencies do not have.
//!
//! EMG has a broad spectrum; a line in it comes from the mains. Harmonics alias at 200 Hz: 150 Hz to 50 Hz, 180 Hz to
//! 20 Hz. The armband filters the line in EMG mode 2, not in mode 3.

use std::f64::consts::TAU;

use shared::units::{CHANNELS, SAMPLE_RATE_HZ, Sample};

use crate::examiner::finding::Finding;

/// Frequencies of the mains.
const MAINS_HZ: [usize; 2] = [50, 60];
/// Samples of a window: a second, so that a bin is 1 Hz wide.
const WINDOW: usize = SAMPLE_RATE_HZ as usize;
/// Maximum number of windows that are examined, spread over the recording.
const MOST_WINDOWS: usize = 120;
/// Share of a channel's power from which hum is reported; public recordings without it have at most 0.13.
const SHARE: f64 = 0.15;
/// Share of power from which hum is reported in a short recording, where chance has more effect.
const SHORT_SHARE: f64 = 0.3;
/// Seconds below which a recording is short.
const SHORT: usize = 10;

/// Mains hum of a recording.
pub(super) struct Hum {
    hz: usize,
    /// Channels with hum, from 0.
    pub channels: Vec<usize>,
    /// Largest share of a channel's power, in percent.
    pub percent: f64,
}

impl Hum {
    pub fn finding(&self) -> Finding {
        let (hz, percent, channels) = (self.hz, self.percent, self.channels.len());
        let finding = Finding::warning(
            "hum",
            format!(
                "mains hum: up to {percent:.0} % of a channel's power is at {hz} Hz, in {channels} of {CHANNELS} channels"
            ),
            "record in EMG mode 2, which filters it, not in mode 3; wipe the electrodes and keep away from mains cables",
        );
        finding.serious_if(channels == CHANNELS && percent > 50.0)
    }
}

/// Mains hum of a recording, at the stronger of the two frequencies; none below the threshold.
pub(super) fn find(samples: &[Sample]) -> Option<Hum> {
    let windows: Vec<&[Sample]> = samples.chunks_exact(WINDOW).collect();
    let every = windows.len().div_ceil(MOST_WINDOWS).max(1);
    let least = if windows.len() < SHORT {
        SHORT_SHARE
    } else {
        SHARE
    };
    let lines = MAINS_HZ.map(|hz| {
        let shares = shares(windows.iter().step_by(every), hz);
        (hz, shares)
    });
    let worst = |shares: &[f64; CHANNELS]| shares.iter().copied().fold(0.0, f64::max);
    let (hz, shares) = lines
        .into_iter()
        .max_by(|(_, a), (_, b)| worst(a).total_cmp(&worst(b)))?;
    let channels: Vec<usize> = (0..CHANNELS).filter(|&at| shares[at] > least).collect();
    (!channels.is_empty()).then(|| Hum {
        hz,
        channels,
        percent: 100.0 * worst(&shares),
    })
}

/// Share of each channel's power that is in a line at `hz`.
fn shares<'s>(windows: impl Iterator<Item = &'s &'s [Sample]>, hz: usize) -> [f64; CHANNELS] {
    let bins = |offsets: &[isize]| -> Vec<usize> {
        let bin = |&offset: &isize| hz.saturating_add_signed(offset);
        offsets.iter().map(bin).collect()
    };
    let (line, beside) = (bins(&[-1, 0, 1]), bins(&[-6, -5, -4, -3, 3, 4, 5, 6]));
    let wave: Vec<(f64, f64)> = (0..WINDOW)
        .map(|at| (TAU * at as f64 / WINDOW as f64).sin_cos())
        .collect();
    let [mut excess, mut total] = [[0.0; CHANNELS]; 2];
    for window in windows {
        for channel in 0..CHANNELS {
            let mean = window.iter().map(|s| f64::from(s[channel])).sum::<f64>() / WINDOW as f64;
            let values: Vec<f64> = window
                .iter()
                .zip(&wave)
                // A Hann window: a line does not spread beyond its neighbouring bins.
                .map(|(sample, (_, cos))| (f64::from(sample[channel]) - mean) * (0.5 - 0.5 * cos))
                .collect();
            let power = |bins: &[usize]| {
                bins.iter()
                    .map(|&bin| power(&values, bin, &wave))
                    .sum::<f64>()
            };
            let expected = power(&beside) * line.len() as f64 / beside.len() as f64;
            excess[channel] += power(&line) - expected;
            total[channel] += values.iter().map(|value| value * value).sum::<f64>();
        }
    }
    std::array::from_fn(|channel| {
        if total[channel] > 0.0 {
            excess[channel] / total[channel]
        } else {
            0.0
        }
    })
}

/// Power in one bin; the bins sum to the sum of the squares.
fn power(values: &[f64], bin: usize, wave: &[(f64, f64)]) -> f64 {
    let [mut re, mut im] = [0.0; 2];
    for (at, value) in values.iter().enumerate() {
        let (sin, cos) = wave[at * bin % WINDOW];
        re += value * cos;
        im += value * sin;
    }
    2.0 * (re * re + im * im) / WINDOW as f64
}
