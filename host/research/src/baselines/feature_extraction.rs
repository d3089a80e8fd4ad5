//! What each baseline hears of a window.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, WINDOW};

use super::Baseline;
use super::butterworth::LowPass;
use super::features::{
    Spectrum, deviations, mean_absolute, mean_absolutes, root_mean_square, slope_sign_changes,
    variance, waveform_length, zero_crossings,
};
use super::output_steps::OutputSteps;
use super::scaling::Scaling;
use super::stream::WindowSamples;

/// Orders of TraHGR's low-pass filters.
pub const ORDERS: [usize; 3] = [1, 3, 5];

static SPECTRUM: LazyLock<Spectrum> = LazyLock::new(|| Spectrum::new(WINDOW));
static LOW_PASSES: LazyLock<[LowPass; 3]> =
    LazyLock::new(|| ORDERS.map(|order| LowPass::new(order, 90.0, 200.0)));

/// From a window's samples to a network's input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FeatureExtraction {
    baseline: Baseline,
    lstm_step: usize,
    scaling: Option<Scaling>,
}

impl FeatureExtraction {
    /// A front end that has not been scaled yet.
    #[must_use]
    pub const fn new(baseline: Baseline, lstm_step: usize) -> Self {
        Self {
            baseline,
            lstm_step,
            scaling: None,
        }
    }

    /// Fits the z-scores to what this front end made of the training windows: per feature for LDA and
    /// MLP, per channel for the LSTM, none for the others.
    #[must_use]
    pub fn scaled<'a>(self, windows: impl Iterator<Item = &'a [f32]>) -> Self {
        let features = match self.baseline {
            Baseline::Lda => 3 * CHANNELS,
            Baseline::Mlp => 6 * CHANNELS,
            Baseline::Lstm => CHANNELS,
            Baseline::EdTcn | Baseline::TraHgr => return self,
        };
        Self {
            scaling: Some(Scaling::fit(windows, features)),
            ..self
        }
    }

    /// What the baseline's steps speak of.
    #[must_use]
    pub const fn output_steps(&self) -> OutputSteps {
        OutputSteps::of(self.baseline, self.lstm_step)
    }

    /// A window of [`OutputSteps::window`] samples as the network's input.
    ///
    /// Length: LDA 24 and MLP 48, channel after channel; LSTM and ED-TCN 8 an step, step after
    /// step; TraHGR `[channel][sample][order]`, 14 400.
    #[must_use]
    pub fn extract(&self, window: WindowSamples<'_>) -> Vec<f32> {
        let raw = |channel: usize| -> Vec<i32> {
            let samples = window.raw.iter();
            samples.map(|sample| i32::from(sample[channel])).collect()
        };
        let cleaned = |channel: usize| -> Vec<i32> {
            let samples = window.emg.iter();
            samples.map(|sample| i32::from(sample[channel])).collect()
        };
        let channels = 0..CHANNELS;
        let steps = self.output_steps();
        let mut input: Vec<f32> = match self.baseline {
            Baseline::Lda => channels
                .map(cleaned)
                .flat_map(|x| {
                    [
                        root_mean_square(&x),
                        waveform_length(&x),
                        SPECTRUM.median(&x),
                    ]
                })
                .map(|feature| feature as f32)
                .collect(),
            Baseline::Mlp => channels
                .map(raw)
                .flat_map(|x| {
                    [
                        root_mean_square(&x),
                        variance(&x),
                        mean_absolute(&x),
                        slope_sign_changes(&x),
                        zero_crossings(&x),
                        waveform_length(&x),
                    ]
                })
                .map(|feature| feature as f32)
                .collect(),
            Baseline::Lstm => side_by_side(
                channels.map(|channel| deviations(&raw(channel), steps.starts(), steps.inner)),
            ),
            Baseline::EdTcn => side_by_side(
                channels.map(|channel| mean_absolutes(&raw(channel), steps.starts(), steps.inner)),
            ),
            Baseline::TraHgr => channels
                .flat_map(|channel| {
                    let x: Vec<f64> = raw(channel).iter().map(|&x| f64::from(x) / 128.0).collect();
                    let filtered = LOW_PASSES.each_ref().map(|filter| filter.zero_phase(&x));
                    (0..x.len()).flat_map(move |t| [0, 1, 2].map(|order| filtered[order][t] as f32))
                })
                .collect(),
        };
        if let Some(scaling) = &self.scaling {
            scaling.apply(&mut input);
        }
        input
    }
}

/// From one sequence a channel to one group of channels a step.
fn side_by_side(channels: impl Iterator<Item = Vec<f64>>) -> Vec<f32> {
    let channels: Vec<Vec<f64>> = channels.collect();
    (0..channels[0].len())
        .flat_map(|step| channels.iter().map(move |channel| channel[step] as f32))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::stream::preprocess::clean;
    use shared::units::{CleanSample, Sample};

    fn samples(length: usize) -> (Vec<Sample>, Vec<CleanSample>) {
        let raw: Vec<Sample> = (0..length as i32)
            .map(|t| {
                std::array::from_fn(|c| ((37 * t * t + (11 + c as i32) * t) % 256 - 128) as i8)
            })
            .collect();
        let emg = clean(raw.iter().copied()).collect();
        (raw, emg)
    }

    fn extract(front: &FeatureExtraction) -> (Vec<f32>, Vec<Sample>, Vec<CleanSample>) {
        let (raw, emg) = samples(front.output_steps().window);
        let input = front.extract(WindowSamples {
            raw: &raw,
            emg: &emg,
        });
        (input, raw, emg)
    }

    fn channel(raw: &[Sample], channel: usize) -> Vec<i32> {
        raw.iter()
            .map(|sample| i32::from(sample[channel]))
            .collect()
    }

    #[test]
    fn each_peer_hears_what_the_table_says_in_the_order_it_says() {
        let (lda, _, emg) = extract(&FeatureExtraction::new(Baseline::Lda, 1));
        let seventh: Vec<i32> = emg.iter().map(|sample| i32::from(sample[7])).collect();
        assert_eq!(lda.len(), 24);
        assert_eq!(lda[22], waveform_length(&seventh) as f32);

        let (mlp, raw, _) = extract(&FeatureExtraction::new(Baseline::Mlp, 1));
        assert_eq!(mlp.len(), 48);
        assert_eq!(mlp[6 + 4], zero_crossings(&channel(&raw, 1)) as f32);

        let (lstm, raw, _) = extract(&FeatureExtraction::new(Baseline::Lstm, 10));
        assert_eq!(lstm.len(), 50 * 8);
        let newest = variance(&channel(&raw, 3)[500..]).sqrt() as f32;
        assert_eq!(lstm[49 * 8 + 3], newest);

        let (tcn, raw, _) = extract(&FeatureExtraction::new(Baseline::EdTcn, 1));
        assert_eq!(tcn.len(), 20 * 8);
        let second = mean_absolute(&channel(&raw, 5)[25..175]) as f32;
        assert_eq!(tcn[8 + 5], second);

        let (hgr, raw, _) = extract(&FeatureExtraction::new(Baseline::TraHgr, 1));
        assert_eq!(hgr.len(), 8 * 600 * 3);
        let x: Vec<f64> = channel(&raw, 2)
            .iter()
            .map(|&x| f64::from(x) / 128.0)
            .collect();
        let third_order = LowPass::new(3, 90.0, 200.0).zero_phase(&x);
        assert_eq!(hgr[(2 * 600 + 321) * 3 + 1], third_order[321] as f32);
    }

    #[test]
    fn a_scaled_front_end_survives_its_file() {
        let front = FeatureExtraction::new(Baseline::Lstm, 10);
        let (input, ..) = extract(&front);
        let scaled = front.scaled(std::iter::once(input.as_slice()));
        let (again, ..) = extract(&scaled);
        let mean = again.iter().sum::<f32>() / again.len() as f32;
        assert!(mean.abs() < 1e-4, "{mean}");
        let json = serde_json::to_string(&scaled).unwrap();
        assert_eq!(
            serde_json::from_str::<FeatureExtraction>(&json).unwrap(),
            scaled
        );
    }
}
