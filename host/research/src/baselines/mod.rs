//! The paper's five baselines, trained and evaluated as our own models are: the same recordings, split,
//! windows, smoother and metrics. Input features, network and training are their own.
//!
//! [`FeatureExtraction`](feature_extraction::FeatureExtraction) makes features of one window, the network
//! makes logits of them, and the logits of its [`OutputSteps`](output_steps::OutputSteps) become
//! [`LookBackLogits`](shared::pipeline::LookBackLogits). Dimensions are those of the reference's code,
//! which differs from the paper's text here and there.

pub mod butterworth;
pub mod ed_tcn;
pub mod feature_extraction;
pub mod features;
pub mod inference;
pub mod lda;
pub mod lstm;
pub mod mlp;
pub mod network;
pub mod output_steps;
pub mod scaling;
mod settings;
pub mod stream;
pub mod trahgr;
pub mod training;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

pub use settings::{BaselineSettings, SettingsError, find_preset};

use myointent::execution::run_folder::weights_file;

/// One of the paper's baselines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
#[value(rename_all = "kebab-case")]
pub enum Baseline {
    /// Linear discriminant analysis on three features a channel.
    Lda,
    /// Four wide layers on six time-domain features a channel; the reference's name is ANN.
    Mlp,
    /// A recurrent network over moving standard deviations.
    Lstm,
    /// An encoder-decoder of temporal convolutions over moving mean absolute values.
    EdTcn,
    /// A transformer with two paths over the low-passed signal.
    #[serde(rename = "trahgr")]
    #[value(name = "trahgr")]
    TraHgr,
}

impl Baseline {
    /// All five, in the order of the tables.
    pub const ALL: [Self; 5] = [Self::Lda, Self::Mlp, Self::Lstm, Self::EdTcn, Self::TraHgr];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lda => "LDA",
            Self::Mlp => "MLP",
            Self::Lstm => "LSTM",
            Self::EdTcn => "ED-TCN",
            Self::TraHgr => "TraHGR",
        }
    }

    /// Stem of the baseline's files in a run's folder.
    #[must_use]
    pub const fn file(self) -> &'static str {
        match self {
            Self::Lda => "baseline-lda",
            Self::Mlp => "baseline-mlp",
            Self::Lstm => "baseline-lstm",
            Self::EdTcn => "baseline-ed-tcn",
            Self::TraHgr => "baseline-trahgr",
        }
    }

    /// The front end, as fitted to the training windows.
    #[must_use]
    pub fn features_file(self) -> String {
        format!("{}.json", self.file())
    }

    /// What was learnt; its presence says that the baseline has been trained.
    #[must_use]
    pub fn model_file(self) -> String {
        match self {
            Self::Lda => format!("{}-model.json", self.file()),
            Self::Mlp | Self::Lstm | Self::EdTcn | Self::TraHgr => weights_file(self.file()),
        }
    }

    /// Whether it outputs logits for the past of its window too, which a look-ahead needs.
    /// The others name one label a window.
    #[must_use]
    pub const fn looks_back(self) -> bool {
        matches!(self, Self::Lstm | Self::EdTcn)
    }
}
