//! From a preset and the recordings found to the resolved configuration of a run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use thiserror::Error;

use super::config::{Fold, Lag, ResolvedConfig};
use super::lineage;
use super::preset::{LabelLag, Preset};
use crate::dataset::folds::{self, Protocol};
use crate::dataset::labels::lag;
use crate::dataset::split::{Choice, Role, Split, SplitError, SplitOptions};
use crate::dataset::{DataSet, Library, Recording};
use crate::execution::revision::revision;
use crate::execution::run_folder::{RunError, RunFolder};

/// A fold of a cross-validation, before the number of folds is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FoldChoice {
    /// The protocol.
    pub protocol: Protocol,
    /// Number of the fold, from 1 on.
    pub number: usize,
}

/// Why a preset cannot be resolved.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The split cannot be made.
    #[error(transparent)]
    Split(#[from] SplitError),
    /// No labelled recordings were found.
    #[error(
        "none of the {recordings} recordings has labels of the {classes} classes: give labelled recordings with --data"
    )]
    NoLabels {
        /// Recordings found.
        recordings: usize,
        /// Number of classes of the preset.
        classes: usize,
    },
    /// There is no such fold.
    #[error(
        "fold {number} of {of}: expected 2 folds or more, and a number from 1 on up to their number"
    )]
    Fold {
        /// The fold given.
        number: usize,
        /// Number of folds.
        of: usize,
    },
    /// The weights to start from were trained or validated with held-out subjects.
    #[error(
        "{start} was trained or validated with {subjects}, whom this run holds out: start from a run that held them out too"
    )]
    HeldOutSeen {
        /// What training starts from.
        start: PathBuf,
        /// These subjects, separated by commas.
        subjects: String,
    },
    /// The run's folder cannot be used.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl ResolvedConfig {
    /// Assigns the subjects to their roles, and measures the lag of the labels on training subjects alone.
    ///
    /// With a fold, the fold says who is held out, and the validation subjects are drawn at random from the
    /// others; the preset's own lists are for a run without a fold.
    ///
    /// # Errors
    /// When there are too few subjects or no labels.
    pub fn new(
        mut preset: Preset,
        library: &Library,
        data: Option<&Path>,
        strict: bool,
        fold: Option<FoldChoice>,
    ) -> Result<Self, ConfigError> {
        let labelled = Self::labelled(&preset, library)?;
        let fold = fold.map(|choice| Fold {
            number: choice.number,
            of: choice.protocol.folds(labelled.iter().copied()),
        });
        if let Some(Fold { number, of }) = fold {
            if of < 2 || !(1..=of).contains(&number) {
                return Err(ConfigError::Fold { number, of });
            }
            let mut groups = folds::folds(labelled.iter().copied(), of, preset.seed);
            preset.data.held_out = groups.swap_remove(number - 1);
            preset.data.held_out_share = 0.0;
            preset.data.validation.clear();
        }
        let split = split(&preset, &labelled)?;
        let lags = lags(&preset, &labelled, &split);
        Ok(Self {
            variant: preset.name.clone(),
            fold,
            start: None,
            preset,
            data: data.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned())),
            strict,
            recordings: lineage::recordings(library, &split),
            split,
            lags,
            start_weights: None,
            git_revision: revision().map(str::to_owned),
        })
    }

    /// The recordings that have labels of the preset's classes: of the preset's data sets, or of all if none of
    /// these was found.
    ///
    /// # Errors
    /// When there are none.
    pub fn labelled<'l>(
        preset: &Preset,
        library: &'l Library,
    ) -> Result<Vec<&'l Recording>, ConfigError> {
        let vocabulary = preset.vocabulary();
        let labelled: Vec<&Recording> = library
            .recordings
            .iter()
            .filter(|recording| recording.labels_in(vocabulary).iter().any(Option::is_some))
            .collect();
        if labelled.is_empty() {
            return Err(ConfigError::NoLabels {
                recordings: library.recordings.len(),
                classes: vocabulary.classes(),
            });
        }
        let wanted = |recording: &&Recording| preset.data.data_sets.contains(&recording.data_set);
        Ok(if labelled.iter().any(wanted) {
            labelled.into_iter().filter(wanted).collect()
        } else {
            labelled
        })
    }

    /// Starts training from the weights of another run, or from a checkpoint.
    ///
    /// # Errors
    /// When subjects that are held out here were trained on or validated with in that run. A checkpoint alone
    /// does not say who was.
    pub fn start_from(&mut self, start: &Path) -> Result<(), ConfigError> {
        if let Ok(origin) = RunFolder::existing(start).and_then(|run| Self::load(&run)) {
            let seen = |subject: &&String| {
                matches!(
                    origin.split.role(subject),
                    Some(Role::Training | Role::Validation)
                )
            };
            let subjects: Vec<String> = self.split.held_out.iter().filter(seen).cloned().collect();
            if !subjects.is_empty() {
                return Err(ConfigError::HeldOutSeen {
                    start: start.to_owned(),
                    subjects: subjects.join(", "),
                });
            }
        }
        self.start_weights = Some(lineage::start_weights(start)?);
        self.start = Some(std::path::absolute(start).unwrap_or_else(|_| start.to_owned()));
        Ok(())
    }
}

/// Roles of the subjects: as listed, and at random in data sets without a listed subject.
fn split(preset: &Preset, recordings: &[&Recording]) -> Result<Split, SplitError> {
    let subjects = folds::subjects(recordings.iter().copied());
    let data = &preset.data;
    let listed = |list: &[String], share: f64| {
        let mut chosen = Vec::new();
        let mut counts = BTreeMap::new();
        for (&data_set, known) in &subjects {
            let own: Vec<String> = list
                .iter()
                .filter(|s| known.contains(&s.as_str()))
                .cloned()
                .collect();
            if own.is_empty() && known.len() > 2 {
                let wanted = (share * known.len() as f64)
                    .round()
                    .max(f64::from(u8::from(share > 0.0)));
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a fraction of a count"
                )]
                counts.insert(data_set, wanted as usize);
            }
            chosen.extend(own);
        }
        (chosen, counts)
    };
    let (mut held_out, held_out_counts) = listed(&data.held_out, data.held_out_share);
    let (mut validation, validation_counts) = listed(&data.validation, data.validation_share);
    // One draw for both roles, among subjects without a role, so that nobody is drawn twice.
    let listed = |subject: &String| held_out.contains(subject) || validation.contains(subject);
    let rest = recordings
        .iter()
        .copied()
        .filter(|recording| !listed(&recording.subject));
    let drawn = Split::new(
        rest,
        &SplitOptions {
            seed: preset.seed,
            held_out: Choice::PerDataSet(held_out_counts),
            validation: Choice::PerDataSet(validation_counts),
        },
    )?;
    held_out.extend(drawn.held_out);
    validation.extend(
        drawn
            .validation
            .into_iter()
            .filter(|subject| !held_out.contains(subject)),
    );
    let mut split = Split::new(
        recordings.iter().copied(),
        &SplitOptions {
            seed: preset.seed,
            held_out: Choice::Subjects(held_out),
            validation: Choice::Subjects(validation),
        },
    )?;
    if data.most_subjects > 0 {
        let mut kept = Vec::new();
        for known in subjects.values() {
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

/// Lag of the labels of each data set.
fn lags(preset: &Preset, recordings: &[&Recording], split: &Split) -> BTreeMap<DataSet, Lag> {
    let mut by_set: BTreeMap<DataSet, Vec<&Recording>> = BTreeMap::new();
    for recording in recordings {
        let own = by_set.entry(recording.data_set).or_default();
        if split.role(&recording.subject) == Some(Role::Training) {
            own.push(recording);
        }
    }
    by_set
        .into_iter()
        .map(|(data_set, training)| {
            let documented = data_set.label_lag();
            let lag = match preset.data.label_lag {
                LabelLag::None => Lag {
                    samples: 0,
                    estimate: None,
                },
                LabelLag::Estimated => {
                    let estimate = lag::estimate(&training);
                    Lag {
                        samples: estimate.map_or(documented, |found| found.lag_samples),
                        estimate,
                    }
                }
            };
            (data_set, lag)
        })
        .collect()
}
