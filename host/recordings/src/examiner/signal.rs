//! Statistics of a recording's channels that several judgements need.

use shared::units::{CHANNELS, Sample};

/// Amplitude in counts above which a channel is more than the noise of rest.
const LOUD: f64 = 2.0;

/// Samples of a recording, and statistics that are computed once.
pub(super) struct Signal<'s> {
    /// The samples.
    pub samples: &'s [Sample],
    /// Mean of each channel.
    pub means: [f64; CHANNELS],
    /// Mean distance of each channel from its own mean, in counts.
    pub levels: [f64; CHANNELS],
}

impl<'s> Signal<'s> {
    /// Statistics of at least one sample.
    pub fn of(samples: &'s [Sample]) -> Self {
        let means = mean_by_channel(samples, |_, value| value);
        let levels = mean_by_channel(samples, |channel, value| (value - means[channel]).abs());
        Self {
            samples,
            means,
            levels,
        }
    }

    /// Correlation of two channels; 0 if one of them is constant.
    pub(crate) fn correlation(&self, one: usize, other: usize) -> f64 {
        let [mut both, mut first, mut second] = [0.0; 3];
        for sample in self.samples {
            let a = f64::from(sample[one]) - self.means[one];
            let b = f64::from(sample[other]) - self.means[other];
            both += a * b;
            first += a * a;
            second += b * b;
        }
        let norm = (first * second).sqrt();
        if norm > 0.0 { both / norm } else { 0.0 }
    }

    /// Correlation of samples with those `lag` later, of each loud channel, over the pairs that begin at a row `phase`
    /// modulo `of`. In 200 Hz recordings of the armband it is -0.2 to -0.4 for neighbours, and about 0 for others.
    pub(crate) fn autocorrelations(&self, lag: usize, phase: usize, of: usize) -> Vec<f64> {
        let loud = (0..CHANNELS).filter(|&channel| self.levels[channel] > LOUD);
        let correlation = |channel: usize| {
            let off = |sample: &Sample| f64::from(sample[channel]) - self.means[channel];
            let pairs = self.samples.iter().zip(self.samples.iter().skip(lag));
            let [mut both, mut own] = [0.0; 2];
            for (sample, later) in pairs.skip(phase).step_by(of) {
                let (a, b) = (off(sample), off(later));
                both += a * b;
                own += f64::midpoint(a * a, b * b);
            }
            if own > 0.0 { both / own } else { 0.0 }
        };
        loud.map(correlation).collect()
    }
}

/// Mean of a function of each value, by channel.
fn mean_by_channel(samples: &[Sample], of: impl Fn(usize, f64) -> f64) -> [f64; CHANNELS] {
    let mut sums = [0.0; CHANNELS];
    for sample in samples {
        for (channel, sum) in sums.iter_mut().enumerate() {
            *sum += of(channel, f64::from(sample[channel]));
        }
    }
    sums.map(|sum| sum / samples.len().max(1) as f64)
}

/// Mean of values; 0 without any.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
