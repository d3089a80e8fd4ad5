//! The report of a run: one HTML file that stands alone, and the tables that the terminal shows too.
//!
//! Everything is drawn here and nothing is computed: numbers come in as they will be read. The file
//! carries its pictures and its style, so it can be mailed, archived and opened without a network.

mod canvas;
pub mod cell;
mod confusion;
mod curves;
mod offsets;
mod page;
pub mod run_report;
pub mod scores;
mod table;
mod timeline;

use std::path::Path;

use crate::evaluation::EvaluationError;
use crate::execution::run_folder::{RunError, write_whole};

pub use self::{
    confusion::Confusion,
    curves::{Curve, Panel},
    table::Table,
    timeline::{Timeline, timeline_svg},
};

/// All that a report shows; what is empty is left out of the page.
#[derive(Clone, Debug, Default)]
pub struct ReportData {
    /// Headline.
    pub title: String,
    /// One sentence under the headline: what was measured, and on whom.
    pub summary: String,
    /// What produced the numbers: name and value, in the order to be shown.
    pub provenance: Vec<(String, String)>,
    /// Tables, the most important first.
    pub tables: Vec<Table>,
    /// Held-out recordings with true and emitted labels.
    pub timelines: Vec<Timeline>,
    /// Learning curves, one picture per panel.
    pub panels: Vec<Panel>,
    /// True against emitted intents, in samples.
    pub confusion: Option<Confusion>,
    /// Emitted minus true instant of every matched transition, in milliseconds: positive is late.
    pub offsets_ms: Vec<f64>,
    /// What a reader must know before believing the numbers; one paragraph each.
    pub notes: Vec<String>,
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
        /// What the drawing said.
        reason: String,
    },
}

/// Writes the report to `path`, under a temporary name first and renamed when whole.
///
/// # Errors
/// [`ReportError::Write`] when the file system refuses, [`ReportError::Draw`] never with finite sizes.
pub fn write_html(data: &ReportData, path: &Path) -> Result<(), ReportError> {
    let html = page::html(data)?;
    Ok(write_whole(path, html.as_bytes())?)
}

#[cfg(test)]
mod tests;
