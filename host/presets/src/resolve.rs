//! Resolution of a preset and the recordings found to the configuration of a run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::{CHANNELS, Sample};
use thiserror::Error;

use crate::Preset;
use crate::config::{Fold, ResolvedConfig};
use crate::lineage;
use execution::revision::revision;
use execution::run_folder::RunError;
use recordings::alignment::{open_hand, template};
use recordings::folds::{self, Protocol};
use recordings::labels::compensation::Compensation;
use recordings::labels::set_lag::lags;
use recordings::split::{self, Assignment, Role, Split, SplitError, predefined};
use recordings::{Library, Recording};

/// A fold of a cross-validation, before the number of folds is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoldChoice {
    /// The protocol.
    pub protocol: Protocol,
    /// Number of the fold, from 1 on.
    pub number: usize,
}

/// Error of resolving a preset.
#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum ConfigError {
    #[error(transparent)]
    Split(#[from] SplitError),
    #[error(
        "none of the {recordings} recordings has labels of the {classes} classes: give labelled recordings with --data"
    )]
    NoLabels { recordings: usize, classes: usize },
    #[error(
        "fold {number} of {of}: expected 2 folds or more, and a number from 1 on up to their number"
    )]
    Fold { number: usize, of: usize },
    #[error(
        "{start}, or what it started from, was trained on or validated with {subjects}, whom this run leaves out: start from a run that left them out too"
    )]
    HeldOutSeen { start: PathBuf, subjects: String },
    #[error(transparent)]
    Run(#[from] RunError),
}

impl ResolvedConfig {
    /// Assigns the subjects to their roles, and measures the lag of the labels on training subjects alone.
    ///
    /// With a fold, the fold says who is held out, and the validation subjects are drawn at random from the others; the
    /// preset's own lists and the development people of `host/recordings/people.toml` are for a run without a fold.
    /// Test people are in no fold.
    pub fn new(
        mut preset: Preset,
        library: &Library,
        data: Option<&Path>,
        strict: bool,
        fold: Option<FoldChoice>,
    ) -> Result<Self, ConfigError> {
        let labelled = Self::labelled(&preset, library)?;
        let (fold, group) = match fold {
            Some(FoldChoice { protocol, number }) => {
                let mut groups = match protocol {
                    // Numbered over all sets, also those that the preset does not train on.
                    Protocol::LeaveSetsOut => fold_people(&preset, library, protocol),
                    protocol => protocol.groups(developers(&labelled), preset.seed),
                };
                let of = groups.len();
                if of < 2 || !(1..=of).contains(&number) {
                    return Err(ConfigError::Fold { number, of });
                }
                let mut group = groups.swap_remove(number - 1);
                group.retain(|person| labelled.iter().any(|own| own.subject == *person));
                (Some(Fold { number, of }), Some(group))
            }
            None => (None, None),
        };
        let split = split(&mut preset, &labelled, group)?;
        let is_training = |subject: &str| split.role(subject) == Some(Role::Training);
        let lags = lags(&labelled, preset.data.label_lag, &is_training);
        let mut config = Self {
            variant: preset.name.clone(),
            fold,
            start: None,
            seen_before: Vec::new(),
            preset,
            data: data.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned())),
            strict,
            recordings: lineage::recordings(library, &split),
            split,
            lags,
            template: None,
            start_weights: None,
            git_revision: revision().map(str::to_owned),
        };
        config.template = template_of_training_people(&config, &labelled);
        Ok(config)
    }

    /// The recordings that have labels of the preset's classes: of the preset's data sets, or of all if none of these
    /// was found; daily life where the preset learns from it. A set that is not [trained on by default](recordings::DataSet::trained_by_default) is used where the
    /// preset names it, or one of its subjects to hold out.
    pub fn labelled<'l>(
        preset: &Preset,
        library: &'l Library,
    ) -> Result<Vec<&'l Recording>, ConfigError> {
        let mut labelled = with_labels(preset, library);
        if labelled.is_empty() {
            return Err(ConfigError::NoLabels {
                recordings: library.recordings.len(),
                classes: preset.vocabulary().classes(),
            });
        }
        let data = &preset.data;
        labelled.retain(|recording| data.daily_life > 0.0 || !recording.is_daily_life());
        let named = |recording: &&Recording| data.data_sets.contains(&recording.data_set);
        let held_out = |recording: &Recording| {
            let set = recording.data_set.name();
            let mut names = data.held_out.iter();
            names.any(|name| name == set || *name == recording.subject)
        };
        Ok(if labelled.iter().any(named) {
            labelled.into_iter().filter(named).collect()
        } else {
            labelled
                .retain(|recording| recording.data_set.trained_by_default() || held_out(recording));
            labelled
        })
    }

    /// People whom this run's models, or any model that they started from, were trained on or validated with.
    pub fn subjects_seen(&self) -> Vec<String> {
        let split = &self.split;
        let mut seen: Vec<String> =
            [&split.training[..], &split.validation, &self.seen_before].concat();
        seen.sort_unstable();
        seen.dedup();
        seen
    }

    /// Starts training from the weights of another run, or from a checkpoint. The people whom these weights have `seen`
    /// are remembered, also for whatever starts from this run.
    ///
    /// # Errors
    /// When a held-out or test person of this run was trained on or validated with there or before, or the weights
    /// cannot be read.
    pub fn start_from(&mut self, start: &Path, seen: Vec<String>) -> Result<(), ConfigError> {
        let left_out = self.split.held_out.iter().chain(&self.split.test);
        let subjects: Vec<&str> = left_out
            .filter(|subject| seen.contains(subject))
            .map(String::as_str)
            .collect();
        if !subjects.is_empty() {
            return Err(ConfigError::HeldOutSeen {
                start: start.to_owned(),
                subjects: subjects.join(", "),
            });
        }
        self.seen_before = seen;
        self.start_weights = Some(lineage::start_weights(start)?);
        self.start = Some(std::path::absolute(start).unwrap_or_else(|_| start.to_owned()));
        Ok(())
    }
}

/// The people whom each fold holds out, over all data sets: for the data sets of the preset the same as in
/// [`ResolvedConfig::new`] with a fold of [`Protocol::LeaveGroupsOut`] or [`Protocol::LeaveSetsOut`].
pub fn fold_people(preset: &Preset, library: &Library, protocol: Protocol) -> Vec<Vec<String>> {
    protocol.groups(developers(&with_labels(preset, library)), preset.seed)
}

/// The test people who have labels of the preset's classes, over all data sets: in no fold, and in no training.
pub fn test_people(preset: &Preset, library: &Library) -> Vec<String> {
    let labelled = with_labels(preset, library).into_iter();
    let people = labelled.map(|recording| recording.subject.clone());
    let people: BTreeSet<String> = people
        .filter(|subject| predefined::is_test(subject))
        .collect();
    people.into_iter().collect()
}

/// The recordings that have labels of the preset's classes, or are daily life.
fn with_labels<'l>(preset: &Preset, library: &'l Library) -> Vec<&'l Recording> {
    let vocabulary = preset.vocabulary();
    let recordings = library.recordings.iter();
    recordings
        .filter(|recording| recording.teaches(vocabulary))
        .collect()
}

/// Recordings of everybody but the test people.
fn developers<'r>(recordings: &[&'r Recording]) -> impl Iterator<Item = &'r Recording> {
    recordings
        .iter()
        .copied()
        .filter(|recording| !predefined::is_test(&recording.subject))
}

/// Roles of the subjects. With a fold, the preset's lists become the fold's, so that they are saved with the run.
fn split(
    preset: &mut Preset,
    recordings: &[&Recording],
    fold: Option<Vec<String>>,
) -> Result<Split, SplitError> {
    let data = &mut preset.data;
    if let Some(fold) = &fold {
        data.held_out.clone_from(fold);
        data.held_out_share = 0.0;
        data.validation.clear();
    }
    let assignment = Assignment {
        seed: preset.seed,
        held_out: &data.held_out,
        held_out_share: data.held_out_share,
        validation: &data.validation,
        validation_share: data.validation_share,
        predefined: fold.is_none(),
    };
    let mut split = split::assign(recordings.iter().copied(), &assignment)?;
    if data.most_subjects > 0 {
        let mut kept = Vec::new();
        for known in folds::subjects(recordings.iter().copied()).values() {
            let mut own: Vec<String> = split
                .training
                .iter()
                .filter(|s| known.contains(&s.as_str()))
                .cloned()
                .collect();
            own.shuffle(&mut ChaCha8Rng::seed_from_u64(preset.seed));
            own.truncate(data.most_subjects);
            kept.extend(own);
        }
        kept.sort_unstable();
        split.training = kept;
    }
    Ok(split)
}

/// Numbers of the alignment template of a run's training people; none if too few of them open the hand.
fn template_of_training_people(
    config: &ResolvedConfig,
    labelled: &[&Recording],
) -> Option<Vec<i16>> {
    let read = |recording: &Recording| {
        let compensation = config.compensation(recording);
        (config.samples(recording), compensation)
    };
    let is_seen =
        |recording: &&Recording| config.split.role(&recording.subject) == Some(Role::Training);
    let seen = labelled.iter().copied().filter(is_seen);
    let bytes = template(&opens(seen, read))?.to_bytes();
    let numbers = bytes.as_chunks::<2>().0.iter();
    Some(numbers.map(|&two| i16::from_le_bytes(two)).collect())
}

/// Open hand of each person who opens it; `read` gives a recording's samples and its lag compensation.
pub fn opens<'r>(
    recordings: impl Iterator<Item = &'r Recording>,
    read: impl Fn(&Recording) -> (Vec<Sample>, Compensation),
) -> Vec<[f64; CHANNELS]> {
    let mut by_person: BTreeMap<&str, Vec<&Recording>> = BTreeMap::new();
    for recording in recordings {
        let own = by_person.entry(&recording.subject).or_default();
        own.push(recording);
    }
    by_person
        .into_values()
        .filter_map(|own| {
            let streams: Vec<(Vec<Sample>, Vec<Option<Intent>>)> = own
                .iter()
                .map(|recording| {
                    let (samples, compensation) = read(recording);
                    (samples, recording.compensated(compensation).labels)
                })
                .collect();
            let borrowed = streams
                .iter()
                .map(|(samples, labels)| (samples.as_slice(), labels.as_slice()));
            open_hand(borrowed)
        })
        .collect()
}

#[cfg(any(test, feature = "testing"))]
pub mod fixture;
#[cfg(test)]
mod tests;
