//! The paper's baselines: names and files.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use execution::run_folder::weights_file;

/// One of the paper's baselines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
#[value(rename_all = "kebab-case")]
pub(crate) enum Baseline {
    /// Linear discriminant analysis of three features per channel.
    Lda,
    /// Multi-layer perceptron on six time-domain features per channel; the reference calls it ANN.
    Mlp,
    /// Recurrent network on moving standard deviations.
    Lstm,
    /// Encoder-decoder temporal convolutional network on moving mean absolute values.
    EdTcn,
    /// Transformer with a temporal and a featural path over the low-pass filtered signal.
    #[serde(rename = "trahgr")]
    #[value(name = "trahgr")]
    TraHgr,
}

impl Baseline {
    /// All five baselines, in the order of the tables.
    pub(crate) const ALL: [Self; 5] = [Self::Lda, Self::Mlp, Self::Lstm, Self::EdTcn, Self::TraHgr];

    /// Name in tables.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Lda => "LDA",
            Self::Mlp => "MLP",
            Self::Lstm => "LSTM",
            Self::EdTcn => "ED-TCN",
            Self::TraHgr => "TraHGR",
        }
    }

    /// Stem of the baseline's files in a run folder.
    pub(crate) const fn file_stem(self) -> &'static str {
        match self {
            Self::Lda => "baseline-lda",
            Self::Mlp => "baseline-mlp",
            Self::Lstm => "baseline-lstm",
            Self::EdTcn => "baseline-ed-tcn",
            Self::TraHgr => "baseline-trahgr",
        }
    }

    /// File of the feature extraction, with the scaling fitted to the training windows.
    pub(crate) fn features_file(self) -> String {
        format!("{}.json", self.file_stem())
    }

    /// File of the trained model; it exists once the baseline has been trained.
    pub(crate) fn model_file(self) -> String {
        match self {
            Self::Lda => format!("{}-model.json", self.file_stem()),
            Self::Mlp | Self::Lstm | Self::EdTcn | Self::TraHgr => weights_file(self.file_stem()),
        }
    }

    /// Whether the baseline has logits for past patches of its window, too, which a look-ahead needs. The others classify
    /// only the newest sample.
    pub(crate) const fn looks_back(self) -> bool {
        matches!(self, Self::Lstm | Self::EdTcn)
    }
}
