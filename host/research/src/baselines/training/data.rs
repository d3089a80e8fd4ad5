//! Training and validation windows of a baseline, and their features.

use rayon::prelude::*;

use super::{Setup, TrainingError};
use crate::baselines::Baseline;
use crate::baselines::features::FeatureExtraction;
use crate::baselines::windows::{Window, WindowedCorpus};
use execution::progress;

/// A baseline's feature extraction with its training and validation windows.
pub(super) struct TrainingData {
    baseline: Baseline,
    features: FeatureExtraction,
    pub(super) training: WindowedCorpus,
    pub(super) validation: WindowedCorpus,
}

impl TrainingData {
    /// Divides the streams into windows; the features are not scaled yet.
    pub(super) fn new(baseline: Baseline, setup: &Setup<'_>) -> Result<Self, TrainingError> {
        let features = FeatureExtraction::new(baseline, setup.settings.lstm_step);
        let layout = features.frame_layout();
        let stride = setup.settings.stride;
        let training = WindowedCorpus::new(setup.training, layout, stride);
        let validation = WindowedCorpus::new(setup.validation, layout, stride);
        if training.windows.is_empty() || validation.windows.is_empty() {
            return Err(TrainingError::NoWindows {
                baseline: baseline.name(),
                training: training.windows.len(),
                validation: validation.windows.len(),
            });
        }
        progress::log(&format!(
            "{}: {} training windows, {} validation windows",
            baseline.name(),
            training.windows.len(),
            validation.windows.len(),
        ));
        Ok(Self {
            baseline,
            features,
            training,
            validation,
        })
    }

    /// Fits the z-scores to the training windows, for the baselines that have them.
    pub(super) fn fit_scaling(&mut self) {
        if self.features.is_scaled() {
            let unscaled = extract(&self.features, &self.training, &self.training.windows);
            self.features = self
                .features
                .clone()
                .with_scaling(unscaled.iter().map(Vec::as_slice));
        }
    }

    pub(super) const fn baseline(&self) -> Baseline {
        self.baseline
    }

    pub(super) const fn features(&self) -> &FeatureExtraction {
        &self.features
    }

    pub(super) const fn classes(&self) -> usize {
        self.training.classes
    }
}

/// Extracts the features of windows of a corpus.
pub(super) fn extract(
    features: &FeatureExtraction,
    corpus: &WindowedCorpus,
    windows: &[Window],
) -> Vec<Vec<f32>> {
    windows
        .par_iter()
        .map(|&window| features.extract(corpus.samples(window)))
        .collect()
}
