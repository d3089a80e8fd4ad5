//! The report of runs and model files: one HTML file that stands alone, and the tables that the terminal shows too.
//!
//! Numbers are formatted and drawn here, not computed. The file contains its pictures and its style, so it
//! can be mailed, archived and opened without a network.

mod calibrations;
pub mod cell;
mod entry;
pub mod model_report;
mod page;
mod people;
mod pictures;
pub mod recognition;
mod row;
pub mod run_report;
pub mod scores;
pub mod several;
mod table;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use recordings::DataSet;
use recordings::labels::set_lag::Lag;

pub use self::table::Table;
use crate::Cued;

/// Maximum number of entries on one page, for their colours to differ.
pub const MOST_ENTRIES: usize = pictures::LINES.len();

/// Name and value of something that a page states.
pub type Fact = (String, String);

/// Tables for a terminal of 100 columns, and facts below them.
pub fn text(tables: &[Table], facts: &[Fact]) -> String {
    let tables = tables.iter().map(|table| table.text(false) + "\n");
    let facts = facts.iter().map(|(what, how)| format!("{what}: {how}\n"));
    tables.chain(facts).collect()
}

/// Facts on the labels, one for each data set: their lag compensation, and the gestures left out.
pub fn labels(lags: &BTreeMap<DataSet, Lag>, gestures: &BTreeMap<DataSet, Cued>) -> Vec<Fact> {
    let fact = |(data_set, lag): (&DataSet, &Lag)| {
        let mut how = lag.to_string();
        if let Some(own) = gestures.get(data_set).filter(|own| own.cued > 0) {
            how += &format!(
                "; {} of {} gestures are not scored, the muscle does not show when their cue was followed",
                own.left_out(),
                own.cued
            );
        }
        (format!("labels of {}", data_set.name()), how)
    };
    lags.iter().map(fact).collect()
}
