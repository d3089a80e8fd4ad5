//! Conditions of an evaluation: which labels are the truth, and how logits are smoothed to labels.

use serde::{Deserialize, Serialize};
use shared::stream::smoother::{AggregationMode, Settings};

/// Labels that predictions are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Truth {
    /// Labels as published: the times of the cues, as in the paper's evaluation.
    Published,
    /// Lag-compensated labels: moved to the onset of muscle activity, cue by cue or by one constant a data set.
    LagCompensated,
}

shared::names! {
    /// Look-ahead and aggregation mode: which logits a label is based on.
    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum LookAhead {
        /// No look-ahead: the logits of the newest patch.
        None = "0",
        /// 0.25 s of look-ahead, aggregation [`AllRowsFrom`](AggregationMode::AllRowsFrom).
        AllRows = "0.25 s, all rows",
        /// 0.25 s of look-ahead, aggregation [`SameInstant`](AggregationMode::SameInstant).
        SameInstant = "0.25 s, same instant",
    }
}

impl LookAhead {
    /// The smoother's settings; each label is held for 0.1 s in all of them.
    pub(crate) const fn settings(self) -> Settings {
        let mut settings = Settings::PAPER_IN_PATCHES;
        match self {
            Self::None => settings.look_ahead = 0,
            Self::AllRows => settings.aggregation = AggregationMode::AllRowsFrom,
            Self::SameInstant => settings.aggregation = AggregationMode::SameInstant,
        }
        settings
    }
}
