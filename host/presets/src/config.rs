//! Resolved configuration of a run: preset, roles of the subjects, lag of the labels, and the streams that follow from
//! them. It is saved beside the results.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use shared::stream::alignment::Template;
use shared::stream::preprocess::Median;
use shared::units::{SAMPLE_RATE_HZ, Sample};

use crate::Preset;
use execution::fingerprint::Fingerprint;
use execution::run_folder::{RunError, RunFolder, write_whole};
use recordings::corpus::{Corpus, Stream};
use recordings::folds;
use recordings::labels::compensation::Compensation;
use recordings::labels::set_lag::Lag;
use recordings::splice::{self, SpliceOptions};
use recordings::split::{Role, Split};
use recordings::{DataSet, Library, Recording, by_data_set};

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
    pub fn save(&self, run: &RunFolder) -> Result<(), RunError> {
        write_whole(&run.file("preset.toml"), self.preset.to_toml().as_bytes())?;
        run.save_json(CONFIG, self)
    }

    /// Reads the configuration of a run folder.
    pub fn load(run: &RunFolder) -> Result<Self, RunError> {
        run.load_json(CONFIG)
    }

    /// Lag compensation of a recording's labels.
    pub fn compensation(&self, recording: &Recording) -> Compensation {
        let lag = self.lags.get(&recording.data_set);
        lag.map_or(Compensation::NONE, |lag| lag.of_recording(recording))
    }

    /// The alignment template of the run's models.
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
    pub fn without_normalization(&self) -> Self {
        let mut config = self.clone();
        config.preset.data.normalize = false;
        config.preset.data.median = Median::Three;
        config
    }
}

impl ResolvedConfig {
    /// The streams of the training subjects.
    pub fn training(&self, library: &Library) -> Corpus {
        self.corpus(library, Role::Training)
    }

    /// The streams of the validation subjects, which select the checkpoint.
    pub fn validation(&self, library: &Library) -> Corpus {
        self.corpus(library, Role::Validation)
    }

    /// Recordings of the subjects of a role that can be evaluated: those with labels of the vocabulary or movement
    /// outside it.
    pub fn evaluated_recordings<'a>(&self, library: &'a Library, role: Role) -> Vec<&'a Recording> {
        let vocabulary = self.preset.vocabulary();
        let mut recordings = self.split.select(&library.recordings, role);
        recordings.retain(|recording| recording.can_be_evaluated(vocabulary));
        recordings
    }

    /// Spliced recordings, one per subject, with lag-compensated labels; the recordings given are those of one data
    /// set.
    fn spliced(&self, recordings: &[&Recording], seconds: f64) -> Vec<Recording> {
        let own = recordings.iter().map(|recording| self.seen(recording));
        let own: Vec<Recording> = own.collect();
        // The preset's check allows finite values from 0 on.
        let options = SpliceOptions {
            samples: (seconds * f64::from(SAMPLE_RATE_HZ)) as usize,
            count: 1,
            other: self.preset.other(),
            seed: self.preset.seed,
        };
        splice::splice(&own.iter().collect::<Vec<_>>(), &options)
    }

    /// A recording as the preset says, with lag-compensated labels in its vocabulary and all movement outside it.
    fn seen(&self, recording: &Recording) -> Recording {
        let vocabulary = self.preset.vocabulary();
        let compensated = recording.compensated(self.compensation(recording));
        Recording {
            labels: compensated.labels_in(vocabulary),
            other_movement: compensated.movement_outside(vocabulary),
            samples: self.samples(recording),
            ..compensated
        }
    }

    /// Adds a stream of the daily life of each person, weighted so that they have the preset's share beside the others.
    fn add_daily_life(&self, streams: &mut Vec<Stream>, daily_life: &[&Recording]) {
        if daily_life.is_empty() {
            return;
        }
        let daily = daily_life.iter().map(|recording| recording.samples.len());
        let others = streams.iter().map(|stream| stream.emg.len());
        let weight = weight(self.preset.data.daily_life, others.sum(), daily.sum());
        for stream in &mut *streams {
            stream.weight = WEIGHT;
        }
        let people = daily_life.chunk_by(|one, next| one.subject == next.subject);
        streams.extend(people.map(|recordings| {
            let samples = recordings
                .iter()
                .flat_map(|recording| self.samples(recording));
            Stream {
                weight,
                ..Stream::of_daily_life(recordings, samples.collect())
            }
        }));
    }

    fn corpus(&self, library: &Library, role: Role) -> Corpus {
        let vocabulary = self.preset.vocabulary();
        let data = &self.preset.data;
        let (daily_life, gestures): (Vec<_>, Vec<_>) = self
            .split
            .select(&library.recordings, role)
            .into_iter()
            .partition(|recording| recording.is_daily_life());
        let by_set = by_data_set(gestures);
        let subjects = folds::subjects(by_set.values().flatten().copied());
        let most = subjects.values().map(Vec::len).max().unwrap_or(0);
        let mut streams = Vec::new();
        for (data_set, recordings) in &by_set {
            if data.as_published {
                let mut published: Vec<_> = recordings.iter().map(|own| self.seen(own)).collect();
                if !self.preset.other() {
                    published
                        .iter_mut()
                        .for_each(|own| own.other_movement.clear());
                }
                streams.extend(published.into_iter().map(Stream::from));
            }
            if data.spliced_seconds > 0.0 {
                let ratio = most as f64 / subjects[data_set].len() as f64;
                let seconds = data.spliced_seconds * ratio.powf(data.balance);
                let spliced = self.spliced(recordings, seconds);
                streams.extend(spliced.into_iter().map(Stream::from));
            }
        }
        self.add_daily_life(&mut streams, &daily_life);
        let corpus = Corpus {
            vocabulary,
            other: self.preset.other(),
            streams,
        };
        corpus.with_median(data.median)
    }
}

/// Weight of every stream beside one of daily life, so that the share is met within a hundredth.
const WEIGHT: usize = 100;

/// Weight of `samples` samples that gives them a share of the total, 0 to 0.9, beside `others` samples of weight [`WEIGHT`].
fn weight(share: f64, others: usize, samples: usize) -> usize {
    let others = (WEIGHT * others) as f64;
    let weight = share / (1.0 - share) * others / samples.max(1) as f64;
    weight.round().max(1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_weight_gives_the_share_asked_for() {
        for (share, others, samples) in [
            (0.25, 90_000, 20_000),
            (0.05, 70_000, 12_345),
            (0.9, 10, 999),
        ] {
            let own = (weight(share, others, samples) * samples) as f64;
            let found = own / (own + (WEIGHT * others) as f64);
            assert!((found - share).abs() < 0.01, "{found} of {share}");
        }
        assert_eq!(weight(0.0, 1000, 0), 1);
    }
}
