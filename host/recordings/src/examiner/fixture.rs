//! Synthetic EMG: noise whose neighbours correlate as the armband's, with a gesture every few seconds.

use std::fmt::Write as _;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use shared::units::{CHANNELS, Sample};

/// Samples of a person at 200 Hz: two seconds of rest and two of a gesture in turn. Another seed is another person.
pub(crate) fn emg(count: usize, seed: u64) -> Vec<Sample> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let gains: [f64; CHANNELS] = std::array::from_fn(|channel| {
        let at = (channel as f64 + seed as f64 * 2.0) % 8.0;
        6.0 + 4.0 * (at - 4.0).abs()
    });
    let mut before = [0.0; CHANNELS];
    (0..count)
        .map(|at| {
            let active = at / 400 % 2 == 1;
            std::array::from_fn(|channel| {
                let noise: f64 = random.sample(StandardNormal);
                // A moving average: neighbours correlate at -0.29, nothing else does.
                let value = noise - 0.32 * before[channel];
                before[channel] = noise;
                let gain = if active { gains[channel] } else { 2.5 };
                (gain * value - 1.0).round().clamp(-128.0, 127.0) as i8
            })
        })
        .collect()
}

/// The label of each sample of [`emg`]: 2 at the gesture.
pub(crate) fn label(at: usize) -> usize {
    2 * (at / 400 % 2)
}

/// Samples as a csv in ReactEMG's layout; `value` writes a count.
pub(crate) fn csv(samples: &[Sample], value: impl Fn(i8) -> String) -> String {
    let mut text = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n".to_owned();
    for (at, sample) in samples.iter().enumerate() {
        let _ = write!(text, "{}", label(at));
        for &count in sample {
            let _ = write!(text, ",{}", value(count));
        }
        text.push('\n');
    }
    text
}

/// Table with a further column in front.
pub(crate) fn with_column(text: &str, name: &str, value: impl Fn(usize) -> String) -> String {
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let mut with = format!("{name},{header}\n");
    for (row, line) in lines.enumerate() {
        let _ = writeln!(with, "{},{line}", value(row));
    }
    with
}
