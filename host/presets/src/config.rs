//! The resolved configuration of a run: preset, roles of the subjects, lag of the labels. It is saved beside the
//! results.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use shared::stream::alignment::Template;
use shared::stream::preprocess::Median;
use shared::units::Sample;

use crate::Preset;
use execution::fingerprint::Fingerprint;
use execution::run_folder::{RunError, RunFolder, write_whole};
use recordings::labels::compensation::Compensation;
use recordings::labels::set_lag::Lag;
use recordings::split::Split;
use recordings::{DataSet, Recording};

/// Name of the resolved configuration in a run folder.
pub const CONFIG: &str = "config.json";

/// Resolved configuration: all that decides the outcome of a run, except its recordings.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ResolvedConfig {
    /// Name of the preset. It stays apart from the preset, because fingerprints of earlier runs contain it.
    pub variant: String,
    /// The fold of a cross-validation; none without one.
    pub fold: Option<Fold>,
    /// The preset, with everything set that options change.
    pub preset: Preset,
    /// Start of training: a run folder or a checkpoint; none for random weights.
    pub start: Option<PathBuf>,
    /// People whom the weights that training starts from, and their ancestors, were trained on or validated with.
    #[serde(default)]
    pub seen_before: Vec<String>,
    /// Folder of the recordings; none for synthetic ones.
    pub data: Option<PathBuf>,
    /// Whether damaged files are refused; otherwise they are left out.
    pub strict: bool,
    /// Subjects by role.
    pub split: Split,
    /// Lag of the labels of each data set.
    pub lags: BTreeMap<DataSet, Lag>,
    /// The alignment template of the training subjects, its numbers as in [`Template::to_bytes`]; none if too few of
    /// them open the hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub template: Option<Vec<i16>>,
    /// Fingerprint of the recordings of everybody who has a role.
    pub recordings: Fingerprint,
    /// Fingerprint of the weights that training starts from; none for random ones.
    pub start_weights: Option<Fingerprint>,
    /// Source revision of the program that began the run, if known.
    pub git_revision: Option<String>,
}

/// One fold of a cross-validation over subjects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fold {
    /// Number of the fold, from 1 on.
    pub number: usize,
    /// Number of folds.
    pub of: usize,
}

impl ResolvedConfig {
    /// Writes the configuration into a run folder, and the preset also as TOML.
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

    /// Lag compensation of a recording's labels.
    #[must_use]
    pub fn compensation(&self, recording: &Recording) -> Compensation {
        let lag = self.lags.get(&recording.data_set);
        lag.map_or(Compensation::NONE, |lag| lag.of_recording(recording))
    }

    /// The alignment template of the run's models.
    #[must_use]
    pub fn alignment_template(&self) -> Option<Template> {
        let numbers = self.template.as_deref()?;
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        Template::from_bytes(&bytes).ok()
    }

    /// Samples of a recording as the preset says: normalized to the wearer, electrodes rotated to the common
    /// orientation.
    #[must_use]
    pub fn samples(&self, recording: &Recording) -> Vec<Sample> {
        let mut samples = if self.preset.data.normalize {
            recording.normalized_samples()
        } else {
            recording.samples.clone()
        };
        self.align(recording, &mut samples);
        samples
    }

    /// Turns the electrodes of a recording as the preset says.
    pub fn align(&self, recording: &Recording, samples: &mut [Sample]) {
        if self.preset.data.align_electrodes {
            recording.data_set.align(samples);
        }
    }

    /// Configuration without normalization to the wearer, which the baselines do not have, and with the paper's median.
    #[must_use]
    pub fn without_normalization(&self) -> Self {
        let mut config = self.clone();
        config.preset.data.normalize = false;
        config.preset.data.median = Median::Three;
        config
    }
}
