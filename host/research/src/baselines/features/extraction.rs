//! Features that each baseline computes from a window.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, SAMPLE_RATE_HZ, WINDOW};

use super::butterworth::LowPass;
use super::scaling::Scaling;
use super::spectrum::Spectrum;
use super::time_domain::{
    mean_absolute_value, moving_mean_absolute_values, moving_standard_deviations, root_mean_square,
    slope_sign_changes, variance, waveform_length, zero_crossings,
};
use crate::baselines::Baseline;
use crate::baselines::windows::{FrameLayout, WindowSamples};
use execution::fingerprint::Fingerprint;

/// Orders of TraHGR's low-pass filters.
pub(crate) const FILTER_ORDERS: [usize; 3] = [1, 3, 5];
/// Cutoff frequency of these filters in Hz.
const CUTOFF: f64 = 90.0;
const SAMPLE_RATE: f64 = SAMPLE_RATE_HZ as f64;

static SPECTRUM: LazyLock<Spectrum> = LazyLock::new(|| Spectrum::new(WINDOW));
static LOW_PASS_FILTERS: LazyLock<[LowPass; 3]> =
    LazyLock::new(|| FILTER_ORDERS.map(|order| LowPass::new(order, CUTOFF, SAMPLE_RATE)));

/// Conversion of a window's samples to a model's input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FeatureExtraction {
    baseline: Baseline,
    lstm_step: usize,
    scaling: Option<Scaling>,
}

impl FeatureExtraction {
    /// Creates an extraction without scaling.
    pub(crate) const fn new(baseline: Baseline, lstm_step: usize) -> Self {
        Self {
            baseline,
            lstm_step,
            scaling: None,
        }
    }

    /// Fingerprint of a baseline that is trained with these features of these streams.
    pub(crate) fn lineage(&self, streams: Fingerprint) -> Fingerprint {
        Fingerprint::of(&(streams, self))
    }

    /// Whether the baseline's features are z-scored.
    pub(crate) const fn is_scaled(&self) -> bool {
        self.group().is_some()
    }

    /// Fits the z-scores to the unscaled features of the training windows: per feature for LDA and MLP,
    /// per channel for the LSTM, none for the others.
    pub(crate) fn with_scaling<'a>(self, windows: impl Iterator<Item = &'a [f32]>) -> Self {
        Self {
            scaling: self.group().map(|features| Scaling::fit(windows, features)),
            ..self
        }
    }

    /// Number of features that are z-scored together, repeating over the input; none without z-scores.
    const fn group(&self) -> Option<usize> {
        match self.baseline {
            Baseline::Lda => Some(3 * CHANNELS),
            Baseline::Mlp => Some(6 * CHANNELS),
            Baseline::Lstm => Some(CHANNELS),
            Baseline::EdTcn | Baseline::TraHgr => None,
        }
    }

    /// Layout of the frames in the baseline's window.
    pub(crate) const fn frame_layout(&self) -> FrameLayout {
        FrameLayout::of(self.baseline, self.lstm_step)
    }

    /// Computes the model's input from a window of [`FrameLayout::window`] samples.
    ///
    /// Length: LDA 24 and MLP 48, ordered by channel; LSTM and ED-TCN 8 per frame, oldest frame first;
    /// TraHGR 14 400, `[channel][sample][order]`.
    pub(crate) fn extract(&self, window: WindowSamples<'_>) -> Vec<f32> {
        let raw = |channel: usize| -> Vec<i32> {
            let samples = window.raw.iter();
            samples.map(|sample| i32::from(sample[channel])).collect()
        };
        let cleaned = |channel: usize| -> Vec<i32> {
            let samples = window.emg.iter();
            samples.map(|sample| i32::from(sample[channel])).collect()
        };
        let channels = 0..CHANNELS;
        let layout = self.frame_layout();
        let mut input: Vec<f32> = match self.baseline {
            Baseline::Lda => channels
                .map(cleaned)
                .flat_map(|x| {
                    [
                        root_mean_square(&x),
                        waveform_length(&x),
                        SPECTRUM.median_amplitude(&x),
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
                        mean_absolute_value(&x),
                        slope_sign_changes(&x),
                        zero_crossings(&x),
                        waveform_length(&x),
                    ]
                })
                .map(|feature| feature as f32)
                .collect(),
            Baseline::Lstm => interleaved(channels.map(|channel| {
                moving_standard_deviations(&raw(channel), layout.starts(), layout.frame)
            })),
            Baseline::EdTcn => interleaved(channels.map(|channel| {
                moving_mean_absolute_values(&raw(channel), layout.starts(), layout.frame)
            })),
            Baseline::TraHgr => channels
                .flat_map(|channel| {
                    let x: Vec<f64> = raw(channel).iter().map(|&x| f64::from(x) / 128.0).collect();
                    let filtered = LOW_PASS_FILTERS
                        .each_ref()
                        .map(|filter| filter.zero_phase(&x));
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

/// Interleaves one sequence per channel to one group of channels per frame.
fn interleaved(channels: impl Iterator<Item = Vec<f64>>) -> Vec<f32> {
    let channels: Vec<Vec<f64>> = channels.collect();
    (0..channels[0].len())
        .flat_map(|frame| channels.iter().map(move |channel| channel[frame] as f32))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::stream::preprocess::{Median, clean};
    use shared::units::{CleanSample, Sample};

    fn samples(length: usize) -> (Vec<Sample>, Vec<CleanSample>) {
        let raw: Vec<Sample> = (0..length as i32)
            .map(|t| {
                std::array::from_fn(|c| ((37 * t * t + (11 + c as i32) * t) % 256 - 128) as i8)
            })
            .collect();
        let emg = clean(raw.iter().copied(), Median::Three).collect();
        (raw, emg)
    }

    fn extract(extraction: &FeatureExtraction) -> (Vec<f32>, Vec<Sample>, Vec<CleanSample>) {
        let (raw, emg) = samples(extraction.frame_layout().window);
        let input = extraction.extract(WindowSamples {
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
    fn features_have_their_documented_order() {
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
        let second = mean_absolute_value(&channel(&raw, 5)[25..175]) as f32;
        assert_eq!(tcn[8 + 5], second);

        let (hgr, raw, _) = extract(&FeatureExtraction::new(Baseline::TraHgr, 1));
        assert_eq!(hgr.len(), 8 * 600 * 3);
        let x: Vec<f64> = channel(&raw, 2)
            .iter()
            .map(|&x| f64::from(x) / 128.0)
            .collect();
        let third_order = LowPass::new(3, CUTOFF, SAMPLE_RATE).zero_phase(&x);
        assert_eq!(hgr[(2 * 600 + 321) * 3 + 1], third_order[321] as f32);
    }

    #[test]
    fn scaling_survives_its_file() {
        let extraction = FeatureExtraction::new(Baseline::Lstm, 10);
        let (input, ..) = extract(&extraction);
        let scaled = extraction.with_scaling(std::iter::once(input.as_slice()));
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
