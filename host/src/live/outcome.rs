//! What viewers are told of a session that is over.

use serde::Serialize;

use crate::record::told::Told;

/// What was kept of a session.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub(crate) struct Kept {
    pub(crate) good: bool,
    pub(crate) seconds: f64,
    pub(crate) folder: String,
    pub(crate) files: Vec<String>,
    /// How often each class is labelled.
    pub(crate) counts: Vec<(&'static str, usize)>,
    /// Trials that are not used.
    pub(crate) bad: usize,
    pub(crate) findings: Vec<Told>,
    pub(crate) inspect: String,
    pub(crate) personalize: String,
    pub(crate) install: String,
}

/// One measure of both models on what was held back.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) measure: &'static str,
    pub(crate) before: Option<f64>,
    pub(crate) after: Option<f64>,
}

/// What a tuning does.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub(crate) struct Tuning {
    /// `running`, `better`, `worse` or `failed`.
    pub(crate) state: &'static str,
    /// What to know and to do.
    pub(crate) text: String,
    /// How many steps are taken, of how many; 0 of 0 while it does not run.
    pub(crate) steps: usize,
    pub(crate) of: usize,
    pub(crate) rows: Vec<Row>,
    /// Commands that come next.
    pub(crate) commands: Vec<String>,
    /// Whether there is a port, on which [`Installing`] can follow.
    pub(crate) installs: bool,
}

/// What an installation of the tuned model on the board does.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub(crate) struct Installing {
    /// `running`, `done` or `failed`.
    pub(crate) state: &'static str,
    /// What to know and to do.
    pub(crate) text: String,
    /// How many blocks the board has, of how many; 0 of 0 before it was asked.
    pub(crate) blocks: u32,
    pub(crate) of: u32,
}

impl Installing {
    /// Before the board has said anything.
    pub(crate) fn running(text: &str) -> Self {
        Self {
            state: "running",
            text: text.to_owned(),
            blocks: 0,
            of: 0,
        }
    }
}
