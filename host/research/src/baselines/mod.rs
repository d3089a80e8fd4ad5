//! The paper's five baselines, trained and judged on what our own models are: the same recordings, split,
//! windows, smoother and metrics. What is theirs is what they hear, their network and its training.
//!
//! A recording's samples go through a peer's [front end](front_end::FrontEnd), which makes features of one
//! window, then through its network; the logits of its [answers](answers::Answers) become
//! [`Rows`](myointent::inference::Rows). Dimensions are those of the reference's code, which differs from the
//! paper's text here and there.

pub mod answers;
pub mod butterworth;
pub mod ed_tcn;
pub mod evaluation;
pub mod features;
pub mod front_end;
pub mod lda;
pub mod lstm;
pub mod mlp;
pub mod network;
pub mod scaling;
pub mod stream;
pub mod trahgr;
pub mod training;

use clap::ValueEnum;
use serde::{Deserialize, Serialize};

use myointent::execution::run_folder::model_file;

/// One of the paper's baselines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
#[value(rename_all = "kebab-case")]
pub enum Peer {
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

impl Peer {
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

    /// Stem of the peer's files in a run's folder.
    #[must_use]
    pub const fn file(self) -> &'static str {
        match self {
            Self::Lda => "peer-lda",
            Self::Mlp => "peer-mlp",
            Self::Lstm => "peer-lstm",
            Self::EdTcn => "peer-ed-tcn",
            Self::TraHgr => "peer-trahgr",
        }
    }

    /// The front end, as fitted to the training windows.
    #[must_use]
    pub fn front_end_file(self) -> String {
        format!("{}.json", self.file())
    }

    /// What was learnt; its presence says that the peer has been trained.
    #[must_use]
    pub fn model_file(self) -> String {
        match self {
            Self::Lda => format!("{}-model.json", self.file()),
            Self::Mlp | Self::Lstm | Self::EdTcn | Self::TraHgr => model_file(self.file()),
        }
    }

    /// Whether it answers about its window's past too, so that a look-ahead has something to read.
    /// The others name one label a window.
    #[must_use]
    pub const fn looks_back(self) -> bool {
        matches!(self, Self::Lstm | Self::EdTcn)
    }
}

/// How peers are trained; the defaults are the reference's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PeerSettings {
    /// Samples between the ends of two windows.
    pub stride: usize,
    /// Passes over all windows.
    pub epochs: usize,
    /// Windows a step.
    pub batch: usize,
    /// Learning rate, the same throughout.
    pub learning_rate: f64,
    /// Decoupled weight decay, on every parameter.
    pub weight_decay: f32,
    /// Samples from one of the LSTM's steps to the next. The reference's 1 makes 500 steps a window, ten
    /// times the work of 10.
    pub lstm_step: usize,
}

impl Default for PeerSettings {
    fn default() -> Self {
        Self {
            stride: 30,
            epochs: 12,
            batch: 128,
            learning_rate: 1e-4,
            weight_decay: 0.01,
            lstm_step: 1,
        }
    }
}
