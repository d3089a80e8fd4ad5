//! Facts on the lag compensation of each data set's labels, and on the gestures that it left out.

use std::collections::BTreeMap;

use super::Fact;
use crate::Cued;
use recordings::DataSet;
use recordings::labels::set_lag::Lag;

/// Facts, one for each data set: the compensation, and the gestures left out.
#[must_use]
pub fn labels(lags: &BTreeMap<DataSet, Lag>, gestures: &BTreeMap<DataSet, Cued>) -> Vec<Fact> {
    let line = |(data_set, lag): (&DataSet, &Lag)| {
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
    lags.iter().map(line).collect()
}
