//! A recording to be judged.

use shared::intent::Intent;
use shared::units::{CleanSample, Sample};

use crate::dataset::DataSet;

/// One recording to be judged.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Which set.
    pub data_set: DataSet,
    /// Who.
    pub subject: String,
    /// Which recording.
    pub name: String,
    /// Samples as the armband sends them.
    pub raw: Vec<Sample>,
    /// The same samples, cleaned.
    pub emg: Vec<CleanSample>,
    /// Labels as published; none for recordings that nobody published.
    pub published: Option<Vec<Option<Intent>>>,
    /// Lag-compensated labels: moved by the data set's lag.
    pub lag_compensated: Vec<Option<Intent>>,
}
