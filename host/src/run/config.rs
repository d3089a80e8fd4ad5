//! The resolved configuration of a run: the preset, who has which role, how late the labels are. Saved beside the results.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use shared::intent::Intent;
use shared::units::Sample;

use super::preset::Preset;
use crate::dataset::labels::lag::{self, LagEstimate};
use crate::dataset::split::Split;
use crate::dataset::{DataSet, Recording};
use crate::execution::run_folder::{RunError, RunFolder, write_whole};

/// Name of the resolved configuration in a run folder.
pub const CONFIG: &str = "config.json";

/// Who is trained on, who is left out, and how late each data set's labels are.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ResolvedConfig {
    /// What sets the run apart from the others of its study; the preset's name by itself.
    pub variant: String,
    /// Which part of a protocol over several runs this is.
    pub fold: Option<Fold>,
    /// The preset as it runs.
    pub preset: Preset,
    /// What training starts from: a run's folder or a checkpoint; none for fresh weights.
    pub start: Option<PathBuf>,
    /// Where the recordings lie; none for synthetic ones.
    pub data: Option<PathBuf>,
    /// Damaged files are refused rather than left out.
    pub strict: bool,
    /// Subjects by role.
    pub split: Split,
    /// Lag of the labels of each data set.
    pub lags: BTreeMap<DataSet, Lag>,
    /// Revision of the source that resolved the configuration, if known.
    pub git_revision: Option<String>,
}

/// One run of a protocol that leaves everybody out in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fold {
    /// Which, 1 first.
    pub number: usize,
    /// Of how many.
    pub of: usize,
}

/// How late the muscles are after a data set's labels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// Samples that labels are moved by.
    pub samples: usize,
    /// The measurement on training subjects, if it was made.
    pub estimate: Option<LagEstimate>,
}

impl ResolvedConfig {
    /// Writes the configuration into a run folder, the preset also as TOML.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn save(&self, run: &RunFolder) -> Result<(), RunError> {
        write_whole(&run.file("preset.toml"), self.preset.to_toml().as_bytes())?;
        run.save_json(CONFIG, self)
    }

    /// Reads the configuration of a run folder.
    ///
    /// # Errors
    /// When the folder holds none.
    pub fn load(run: &RunFolder) -> Result<Self, RunError> {
        run.load_json(CONFIG)
    }

    /// Samples that labels of a data set are moved by.
    #[must_use]
    pub fn lag(&self, data_set: DataSet) -> usize {
        self.lags.get(&data_set).map_or(0, |lag| lag.samples)
    }

    /// Labels of a recording in the preset's vocabulary, moved by its data set's lag.
    #[must_use]
    pub fn lag_compensated_labels(&self, recording: &Recording) -> Vec<Option<Intent>> {
        lag::compensated(
            &recording.labels_in(self.preset.vocabulary()),
            self.lag(recording.data_set),
        )
    }

    /// Samples of a recording as models get them, electrodes aligned if the preset says so.
    #[must_use]
    pub fn samples(&self, recording: &Recording) -> Vec<Sample> {
        if self.preset.data.align_electrodes {
            recording.aligned_samples()
        } else {
            recording.samples.clone()
        }
    }
}
