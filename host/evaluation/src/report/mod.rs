//! The report of runs and model files: one HTML file that stands alone, and the tables that the terminal shows too.
//!
//! Numbers are formatted and drawn here, not computed. The file contains its pictures and its style, so it
//! can be mailed, archived and opened without a network.

mod alignment;
mod canvas;
pub mod cell;
mod confusion;
mod curves;
mod device;
mod entry;
pub mod labels;
mod latencies;
pub mod model_report;
mod overview;
mod page;
mod people;
mod people_table;
pub mod personalization;
pub mod run_report;
pub mod scores;
mod seen;
pub mod several;
mod side_by_side;
mod table;
mod timeline;

use std::path::Path;

use self::curves::Panel;
use self::device::Device;
pub use self::entry::MOST_ENTRIES;
use self::overview::Row;
use self::people::People;
pub use self::table::Table;
use self::timeline::Timeline;
use crate::EvaluationError;
use crate::metric::confusion::Confusion;
use execution::run_folder::{RunError, write_whole};

/// Name and value of something that a page states.
type Fact = (String, String);

/// Contents of a report; empty parts are left out of the page.
#[derive(Clone, Debug, Default)]
struct ReportData {
    /// Headline.
    title: String,
    /// One sentence under the headline: what was evaluated, and on whom.
    summary: String,
    /// Numbers at the top of the page.
    headline: Vec<Headline>,
    /// Origin of the numbers, in groups with a name, which may be empty.
    provenance: Vec<(String, Vec<Fact>)>,
    /// Means at a glance.
    overview: Vec<Row>,
    /// Tables, the most important first.
    tables: Vec<Table>,
    /// Tables that few readers need, at the end of the page.
    more_tables: Vec<Table>,
    /// Picture with a bar for each person.
    people: Option<People>,
    /// Scores of each person.
    people_tables: Vec<Table>,
    /// Sentence on whose recordings are drawn.
    drawn: String,
    /// Recordings with true and emitted labels.
    timelines: Vec<Timeline>,
    /// Learning curves, one picture per panel.
    panels: Vec<Panel>,
    /// Errors of each entry.
    errors: Vec<Errors>,
    /// Cost of the models on a board.
    device: Vec<Device>,
    /// Limits of the numbers; one paragraph each.
    notes: Vec<String>,
}

/// A number at the top of the page.
#[derive(Clone, Debug, Default)]
struct Headline {
    name: String,
    value: String,
    /// Interval or unit.
    remark: String,
    /// Number of the energy detector.
    floor: Option<String>,
}

/// Errors in the labels of an entry.
#[derive(Clone, Debug, Default)]
struct Errors {
    /// Name of the entry.
    name: String,
    /// True and emitted labels, in samples.
    confusion: Option<Confusion>,
    /// Latency of every gesture in samples; none for those that were missed.
    latencies: Vec<Option<i32>>,
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
