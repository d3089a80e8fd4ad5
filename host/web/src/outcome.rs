//! Messages to viewers about a session that is over.

use recordings::Severity;
use serde::Serialize;

use crate::installer::{InstallError, Installer};
use crate::record::quality::Quality;
use crate::said::Said;

/// Finding as a sentence, with its severity and advice.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
#[expect(missing_docs, reason = "names of the page's messages")]
pub struct FindingText {
    pub severity: Severity,
    #[serde(flatten)]
    pub said: Said,
    pub advice: &'static str,
}

/// Result of a session that was kept.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[expect(missing_docs, reason = "names of the page's messages")]
pub struct SessionResult {
    pub good: bool,
    pub seconds: f64,
    pub folder: String,
    pub files: Vec<String>,
    /// Number of labelled stretches of each class.
    pub counts: Vec<(&'static str, usize)>,
    /// Number of trials that are not used.
    pub bad: usize,
    pub findings: Vec<FindingText>,
    pub inspect: String,
    pub personalize: String,
    pub install: String,
}

impl SessionResult {
    /// Result of recordings of this quality, with the commands that inspect them, tune a model on them, and install it.
    pub fn of(
        quality: &Quality,
        bad: usize,
        folder: String,
        files: Vec<String>,
        [inspect, personalize, install]: [String; 3],
    ) -> Self {
        let counts = quality.counts.iter();
        Self {
            good: quality.is_good_enough(),
            seconds: quality.seconds,
            folder,
            files,
            counts: counts.map(|(&class, &count)| (class, count)).collect(),
            bad,
            findings: quality.findings.iter().map(FindingText::from).collect(),
            inspect,
            personalize,
            install,
        }
    }
}

/// Measure of both models on the part held back.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[expect(missing_docs, reason = "names of the page's messages")]
pub struct MeasureRow {
    /// Name of the measure: `balanced-accuracy`, `recognised`.
    pub measure: &'static str,
    pub before: Option<f64>,
    pub after: Option<f64>,
}

/// State of a tuning.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "names of the page's messages")]
pub struct TuningState {
    /// `running`, `better`, `worse` or `failed`.
    pub state: &'static str,
    /// Why it failed, or why the new model is not better; null without a reason.
    pub why: Option<Said>,
    /// Seconds of recordings that the model was tuned on, and that were held back to judge it; null before.
    pub tuned_seconds: Option<f64>,
    pub judged_seconds: Option<f64>,
    /// File of the new model; null without one.
    pub file: Option<String>,
    /// Doubts about the recordings.
    pub doubts: Vec<Said>,
    /// Number of steps done, and of all; 0 of 0 while no tuning runs.
    pub steps: usize,
    pub of: usize,
    pub rows: Vec<MeasureRow>,
    /// Commands to run next.
    pub commands: Vec<String>,
}

impl TuningState {
    /// State of a tuning that has failed, or cannot begin.
    pub fn failed(why: Said) -> Self {
        Self {
            state: "failed",
            why: Some(why),
            ..Self::default()
        }
    }
}

/// State of an installation of a model on the board, or of one that runs here.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
#[expect(missing_docs, reason = "names of the page's messages")]
pub struct InstallationState {
    /// `running`, `done` or `failed`.
    pub state: &'static str,
    /// Why it failed; null without a reason.
    pub why: Option<Said>,
    /// Whether another installation goes on where this one ended.
    pub goes_on: bool,
    /// CRC-32 of the model, once it is in use.
    pub model: Option<String>,
    /// Part that the board has, and the whole; 0 of 0 before its first answer.
    pub blocks: u32,
    pub of: u32,
}

impl InstallationState {
    /// State of an installation; its progress in whole percent.
    pub fn of(installer: &Installer) -> Self {
        let (state, model) = match installer.end() {
            None => ("running", None),
            Some(Ok(())) => ("done", Some(format!("{:08x}", installer.checksum()))),
            Some(Err(error)) => return Self::failed(error),
        };
        let percent = |blocks| (100 * blocks / installer.of().max(1), 100);
        let (blocks, of) = installer.blocks().map_or((0, 0), percent);
        Self {
            state,
            model,
            blocks,
            of,
            ..Self::default()
        }
    }

    /// State of a model that runs here.
    pub fn here(checksum: u32) -> Self {
        Self {
            state: "done",
            model: Some(format!("{checksum:08x}")),
            ..Self::default()
        }
    }

    /// State of an installation that has failed, or cannot begin.
    pub fn failed(error: &InstallError) -> Self {
        Self {
            goes_on: error.goes_on(),
            ..Self::refused(Said::of("board", error))
        }
    }

    /// State of a model that is not run here.
    pub fn refused(why: Said) -> Self {
        Self {
            state: "failed",
            why: Some(why),
            ..Self::default()
        }
    }
}
