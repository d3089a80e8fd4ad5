//! Two of the paper's baselines, LSTM and ED-TCN, trained and evaluated like the product's own models: same recordings,
//! split, smoother and metrics. Input features, network and training settings are their own.
//!
//! [`FeatureExtraction`] makes features of a window, a [`Network`](networks::Network) makes logits of the features, and
//! [`FrameLayout`](windows::FrameLayout) makes [`LookBackLogits`](shared::model::LookBackLogits) of the logits of the window's
//! frames. Dimensions are those of the reference's code, which differs from the paper's text in places.
//!
//! [`FeatureExtraction`]: features::FeatureExtraction

mod features;
pub(crate) mod inference;
mod networks;
pub(crate) mod training;
mod windows;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

/// One of the paper's baselines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
#[value(rename_all = "kebab-case")]
pub(crate) enum Baseline {
    /// Recurrent network on moving standard deviations.
    Lstm,
    /// Encoder-decoder temporal convolutional network on moving mean absolute values.
    EdTcn,
}

impl Baseline {
    /// All baselines, in the order of the tables.
    pub(crate) const ALL: [Self; 2] = [Self::Lstm, Self::EdTcn];

    /// Name in tables.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Lstm => "LSTM",
            Self::EdTcn => "ED-TCN",
        }
    }

    /// Stem of the baseline's files in a run folder.
    pub(crate) const fn file_stem(self) -> &'static str {
        match self {
            Self::Lstm => "baseline-lstm",
            Self::EdTcn => "baseline-ed-tcn",
        }
    }

    /// File of the feature extraction, with the scaling fitted to the training windows.
    pub(crate) fn features_file(self) -> String {
        format!("{}.json", self.file_stem())
    }
}

/// Training settings of all baselines; the defaults are for two cores.
///
/// Against the reference's (stride 30, 12 epochs, learning rate 1e-4, an LSTM time step every sample): a higher learning rate,
/// a quarter of the windows and a third of the epochs (the validation loss is lowest after one to three), and fewer time steps.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct BaselineSettings {
    /// Samples between the ends of consecutive training windows.
    pub(crate) stride: usize,
    /// Number of passes over all training windows.
    pub(crate) epochs: usize,
    /// Number of windows per optimizer step.
    pub(crate) batch: usize,
    /// Constant learning rate.
    pub(crate) learning_rate: f64,
    /// Decoupled weight decay of every parameter.
    pub(crate) weight_decay: f32,
    /// Samples between consecutive LSTM time steps, 1 to 500.
    pub(crate) lstm_step: usize,
}

impl Default for BaselineSettings {
    fn default() -> Self {
        Self {
            stride: 120,
            epochs: 4,
            batch: 128,
            learning_rate: 5e-4,
            weight_decay: 0.01,
            lstm_step: 25,
        }
    }
}
