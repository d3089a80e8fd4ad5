//! The report of a run: one HTML file that stands alone, and the tables that the terminal shows too.
//!
//! Numbers are formatted and drawn here, not computed. The file contains its pictures and its style, so it
//! can be mailed, archived and opened without a network.

mod alignment;
mod canvas;
pub mod cell;
mod confusion;
mod curves;
mod latencies;
pub mod model_report;
mod page;
pub mod personalization;
pub mod run_report;
pub mod scores;
mod table;
mod timeline;

use std::path::Path;

use shared::intent::Vocabulary;

use self::curves::Panel;
pub use self::table::Table;
use self::timeline::Timeline;
use crate::evaluation::metric::confusion::Confusion;
use crate::evaluation::{Candidate, EvaluationError, LookAhead, Trial, confusion, gestures};
use crate::execution::run_folder::{RunError, write_whole};

/// Contents of a report; empty parts are left out of the page.
#[derive(Clone, Debug, Default)]
struct ReportData {
    /// Headline.
    title: String,
    /// One sentence under the headline: what was evaluated, and on whom.
    summary: String,
    /// What produced the numbers: name and value, in the order to be shown.
    provenance: Vec<(String, String)>,
    /// Tables, the most important first.
    tables: Vec<Table>,
    /// Headline of the recordings that are drawn.
    drawn: String,
    /// Recordings with true and emitted labels.
    timelines: Vec<Timeline>,
    /// Learning curves, one picture per panel.
    panels: Vec<Panel>,
    /// True against emitted labels, in samples.
    confusion: Option<Confusion>,
    /// Latency of every gesture in samples; none for those that were missed.
    latencies: Vec<Option<i32>>,
    /// Limits of the numbers; one paragraph each.
    notes: Vec<String>,
}

impl ReportData {
    /// Adds the confusion and the latencies of a candidate.
    ///
    /// # Errors
    /// When labels cannot be compared or the smoother's settings are invalid.
    fn add_errors(
        &mut self,
        candidate: &Candidate,
        trials: &[Trial],
        vocabulary: Vocabulary,
        look_ahead: LookAhead,
    ) -> Result<(), EvaluationError> {
        self.confusion = Some(confusion(candidate, trials, vocabulary, look_ahead)?);
        self.latencies = gestures(candidate, trials, vocabulary, look_ahead)?
            .into_iter()
            .map(|gesture| gesture.latency)
            .collect();
        Ok(())
    }
}

/// Why a report was not written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The file could not be written whole; nothing of an older one was touched.
    #[error(transparent)]
    Write(#[from] RunError),
    /// The labels or scores of a picture cannot be computed.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// A picture could not be laid out.
    #[error("report: the picture {picture:?} cannot be drawn ({reason}): this is a bug")]
    Draw {
        /// Title of the picture.
        picture: String,
        /// The drawing library's message.
        reason: String,
    },
}

/// Writes the report to `path`, under a temporary name first and renamed when whole.
///
/// # Errors
/// [`ReportError::Write`] when the file system refuses, [`ReportError::Draw`] never with finite sizes.
fn write_html(data: &ReportData, path: &Path) -> Result<(), ReportError> {
    let html = page::html(data)?;
    Ok(write_whole(path, html.as_bytes())?)
}

#[cfg(test)]
mod tests;
