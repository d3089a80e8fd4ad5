//! Features that each baseline computes from a window.

use serde::{Deserialize, Serialize};
use shared::units::{CHANNELS, Sample};

use super::moving::{moving_mean_absolute_values, moving_standard_deviations};
use super::scaling::Scaling;
use crate::baselines::Baseline;
use crate::baselines::windows::FrameLayout;
use execution::fingerprint::Fingerprint;

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
        matches!(self.baseline, Baseline::Lstm)
    }

    /// Fits the z-scores of each channel to the unscaled features of the training windows.
    pub(crate) fn with_scaling<'a>(self, windows: impl Iterator<Item = &'a [f32]>) -> Self {
        Self {
            scaling: Some(Scaling::fit(windows, CHANNELS)),
            ..self
        }
    }

    /// Layout of the frames in the baseline's window.
    pub(crate) const fn frame_layout(&self) -> FrameLayout {
        FrameLayout::of(self.baseline, self.lstm_step)
    }

    /// Computes the model's input, 8 numbers per frame, oldest frame first, from a window of [`FrameLayout::window`] samples as
    /// the armband sends them.
    pub(crate) fn extract(&self, window: &[Sample]) -> Vec<f32> {
        let layout = self.frame_layout();
        let channels: Vec<Vec<f64>> = (0..CHANNELS)
            .map(|channel| {
                let x: Vec<i32> = window.iter().map(|own| i32::from(own[channel])).collect();
                match self.baseline {
                    Baseline::Lstm => moving_standard_deviations(&x, layout.starts(), layout.frame),
                    Baseline::EdTcn => {
                        moving_mean_absolute_values(&x, layout.starts(), layout.frame)
                    }
                }
            })
            .collect();
        let mut input: Vec<f32> = (0..layout.count)
            .flat_map(|frame| channels.iter().map(move |channel| channel[frame] as f32))
            .collect();
        if let Some(scaling) = &self.scaling {
            scaling.apply(&mut input);
        }
        input
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extract(extraction: &FeatureExtraction) -> (Vec<f32>, Vec<Sample>) {
        let raw: Vec<Sample> = (0..extraction.frame_layout().window as i32)
            .map(|t| {
                std::array::from_fn(|c| ((37 * t * t + (11 + c as i32) * t) % 256 - 128) as i8)
            })
            .collect();
        (extraction.extract(&raw), raw)
    }

    fn channel(raw: &[Sample], channel: usize) -> Vec<i32> {
        raw.iter()
            .map(|sample| i32::from(sample[channel]))
            .collect()
    }

    #[test]
    fn features_have_their_documented_order() {
        let (lstm, raw) = extract(&FeatureExtraction::new(Baseline::Lstm, 10));
        assert_eq!(lstm.len(), 50 * 8);
        let newest = moving_standard_deviations(&channel(&raw, 3), std::iter::once(500), 100);
        assert_eq!(lstm[49 * 8 + 3], newest[0] as f32);

        let (tcn, raw) = extract(&FeatureExtraction::new(Baseline::EdTcn, 1));
        assert_eq!(tcn.len(), 20 * 8);
        let second = moving_mean_absolute_values(&channel(&raw, 5), std::iter::once(25), 150);
        assert_eq!(tcn[8 + 5], second[0] as f32);
    }

    #[test]
    fn scaling_survives_its_file() {
        let extraction = FeatureExtraction::new(Baseline::Lstm, 10);
        let (input, _) = extract(&extraction);
        let scaled = extraction.with_scaling(std::iter::once(input.as_slice()));
        let (again, _) = extract(&scaled);
        let mean = again.iter().sum::<f32>() / again.len() as f32;
        assert!(mean.abs() < 1e-4, "{mean}");
        let json = serde_json::to_string(&scaled).unwrap();
        assert_eq!(
            serde_json::from_str::<FeatureExtraction>(&json).unwrap(),
            scaled
        );
    }
}
