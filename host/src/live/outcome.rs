//! Messages to viewers about a session that is over.

use serde::Serialize;

use crate::record::quality::FindingText;

/// Result of a session that was kept.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub(crate) struct SessionResult {
    pub(crate) good: bool,
    pub(crate) seconds: f64,
    pub(crate) folder: String,
    pub(crate) files: Vec<String>,
    /// Number of labelled stretches of each class.
    pub(crate) counts: Vec<(&'static str, usize)>,
    /// Number of trials that are not used.
    pub(crate) bad: usize,
    pub(crate) findings: Vec<FindingText>,
    pub(crate) inspect: String,
    pub(crate) personalize: String,
    pub(crate) install: String,
}

/// Measure of both models on the part held back.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub(crate) struct MeasureRow {
    pub(crate) measure: &'static str,
    pub(crate) before: Option<f64>,
    pub(crate) after: Option<f64>,
}

/// State of a tuning.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub(crate) struct TuningState {
    /// `running`, `better`, `worse` or `failed`.
    pub(crate) state: &'static str,
    /// Explanation and advice.
    pub(crate) text: String,
    /// Number of steps done, and of all; 0 of 0 while no tuning runs.
    pub(crate) steps: usize,
    pub(crate) of: usize,
    pub(crate) rows: Vec<MeasureRow>,
    /// Commands to run next.
    pub(crate) commands: Vec<String>,
    /// Whether the source is a serial port, on which [`InstallationState`] can follow.
    pub(crate) installs: bool,
}

/// State of an installation of the tuned model on the board.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub(crate) struct InstallationState {
    /// `running`, `done` or `failed`.
    pub(crate) state: &'static str,
    /// Explanation and advice.
    pub(crate) text: String,
    /// Number of blocks that the board has, and of all; 0 of 0 before the board was asked.
    pub(crate) blocks: u32,
    pub(crate) of: u32,
}

impl InstallationState {
    /// State of an installation before the board's first answer.
    pub(crate) fn running(text: &str) -> Self {
        Self {
            state: "running",
            text: text.to_owned(),
            blocks: 0,
            of: 0,
        }
    }
}
