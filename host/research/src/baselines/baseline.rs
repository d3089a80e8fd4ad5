//! The paper's baselines: names and files.

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
