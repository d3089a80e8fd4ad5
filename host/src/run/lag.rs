//! How much later than its labels the muscle acts in a data set, and what is done about it.

use std::collections::BTreeMap;

use super::config::Lag;
use super::preset::LabelLag;
use crate::dataset::labels::compensation::Compensation;
use crate::dataset::labels::lag::estimate;
use crate::dataset::{DataSet, Recording, by_data_set};

impl Lag {
    /// That of a data set; a constant is estimated on these recordings of it.
    pub(super) fn of(data_set: DataSet, recordings: &[&Recording], label_lag: LabelLag) -> Self {
        let without_estimate = |compensation| Self {
            compensation,
            estimate: None,
        };
        match label_lag {
            LabelLag::None => without_estimate(Compensation::NONE),
            LabelLag::EachCue if data_set.rests_around_cues() => {
                without_estimate(Compensation::EachCue)
            }
            LabelLag::EachCue | LabelLag::Estimated => {
                let estimate = estimate(recordings);
                let samples = estimate.map_or(data_set.label_lag(), |found| found.lag_samples);
                Self {
                    compensation: Compensation::Constant(samples),
                    estimate,
                }
            }
        }
    }
}

/// How the labels of each data set are compensated for their lag; a constant is estimated on the recordings.
pub(super) fn lags(
    recordings: &[&Recording],
    label_lag: LabelLag,
) -> BTreeMap<DataSet, Compensation> {
    by_data_set(recordings.iter().copied())
        .into_iter()
        .map(|(data_set, own)| {
            let lag = Lag::of(data_set, &own, label_lag);
            (data_set, lag.compensation)
        })
        .collect()
}
