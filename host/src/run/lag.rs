//! How much later than its labels the muscle acts, for all data sets of some recordings.

use std::collections::BTreeMap;

use recordings::labels::lag::LabelLag;
use recordings::labels::set_lag::Lag;
use recordings::{DataSet, Recording, by_data_set};

/// How the labels of each data set are compensated for their lag; a constant is estimated on training people.
pub(super) fn lags(
    recordings: &[&Recording],
    label_lag: LabelLag,
    is_training: &dyn Fn(&str) -> bool,
) -> BTreeMap<DataSet, Lag> {
    by_data_set(recordings.iter().copied())
        .into_iter()
        .map(|(data_set, own)| (data_set, Lag::of(data_set, &own, label_lag, is_training)))
        .collect()
}
