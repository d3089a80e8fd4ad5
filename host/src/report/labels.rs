//! What was done about the lag of each data set's labels, and how many gestures it left out.

use std::collections::BTreeMap;

use super::Fact;
use crate::dataset::DataSet;
use crate::dataset::labels::set_lag::Lag;
use crate::evaluation::Cued;

/// A line for each data set: what, and how.
#[must_use]
pub fn labels(lags: &BTreeMap<DataSet, Lag>, gestures: &BTreeMap<DataSet, Cued>) -> Vec<Fact> {
    let line = |(data_set, lag): (&DataSet, &Lag)| {
        let mut how = lag.to_string();
        if let Some(Cued { cued, labelled }) = gestures.get(data_set).filter(|own| own.cued > 0) {
            how += &format!(
                "; {} of {cued} gestures left out of the truth, no muscle follows their cue",
                cued - labelled
            );
        }
        (format!("labels of {}", data_set.name()), how)
    };
    lags.iter().map(line).collect()
}
