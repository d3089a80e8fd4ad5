//! From a preset and the recordings at hand to what will run: who is left out, how late the labels
//! are, which streams are trained on. Saved beside the results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use shared::intent::Intent;
use shared::units::{SAMPLE_RATE_HZ, Sample};
use thiserror::Error;

use crate::dataset::corpus::{Corpus, Stream};
use crate::run::preset::{LabelLag, Preset};
use crate::dataset::folds::{self, Protocol};
use crate::dataset::lag::{self, LagEstimate};
use crate::dataset::splice::{self, SpliceOptions};
use crate::dataset::split::{Choice, Role, Split, SplitError, SplitOptions};
use crate::dataset::DataSet;
use crate::dataset::Library;
use crate::dataset::Recording;
use crate::execution::run_folder::{RunError, RunFolder};

const FILE: &str = "plan.json";

/// Who is trained on, who is left out, and how late each data set's labels are.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
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
    /// Damaged files are left out.
    pub skip_bad: bool,
    /// Subjects by role.
    pub split: Split,
    /// Lag of the labels of each data set.
    pub lags: BTreeMap<DataSet, Lag>,
    /// Revision of the source that made the plan, if known.
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

/// A run of a protocol, before it is known how many there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// The protocol.
    pub protocol: Protocol,
    /// Which run, 1 first.
    pub number: usize,
}

/// How late the muscles are after a data set's labels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// Samples that labels are moved by.
    pub samples: usize,
    /// The measurement on training subjects, if it was made.
    pub estimate: Option<LagEstimate>,
}

/// Why no plan can be made.
#[derive(Debug, Error)]
pub enum PlanError {
    /// The split cannot be made.
    #[error(transparent)]
    Split(#[from] SplitError),
    /// Nothing labelled is at hand.
    #[error(
        "none of the {recordings} recordings has labels of the {classes} classes: give labelled recordings with --data"
    )]
    NoLabels {
        /// Recordings found.
        recordings: usize,
        /// Classes wanted.
        classes: usize,
    },
    /// There is no such fold.
    #[error(
        "fold {number} of {of}: expected 2 folds or more, and a number from 1 on up to their number"
    )]
    Fold {
        /// The fold asked for.
        number: usize,
        /// Number of folds.
        of: usize,
    },
    /// What training starts from has seen people who are to be left out.
    #[error(
        "{start} was trained or validated with {subjects}, whom this run leaves out: start from a run that left them out too"
    )]
    Seen {
        /// What training starts from.
        start: PathBuf,
        /// Who, separated by commas.
        subjects: String,
    },
    /// The run's folder cannot be used.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl Plan {
    /// Decides who is left out and measures the labels' lag on training subjects alone.
    ///
    /// With a turn of a protocol, the protocol says who is left out, and a share of the others,
    /// drawn by the seed, chooses the checkpoint; the preset's own lists are for a run without one.
    ///
    /// # Errors
    /// When too few subjects or no labels are at hand.
    pub fn new(
        mut preset: Preset,
        library: &Library,
        data: Option<&Path>,
        skip_bad: bool,
        turn: Option<Turn>,
    ) -> Result<Self, PlanError> {
        let labelled = Self::labelled(&preset, library)?;
        let fold = turn.map(|turn| Fold {
            number: turn.number,
            of: turn.protocol.folds(labelled.iter().copied()),
        });
        if let Some(Fold { number, of }) = fold {
            if of < 2 || !(1..=of).contains(&number) {
                return Err(PlanError::Fold { number, of });
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
            skip_bad,
            split,
            lags,
            git_revision: git_revision(),
        })
    }

    /// The recordings that have labels of the preset's classes, of the data sets that it wants; of
    /// all if none of those is at hand.
    ///
    /// # Errors
    /// When there are none.
    pub fn labelled<'l>(
        preset: &Preset,
        library: &'l Library,
    ) -> Result<Vec<&'l Recording>, PlanError> {
        let vocabulary = preset.vocabulary();
        let labelled: Vec<&Recording> = library
            .recordings
            .iter()
            .filter(|recording| recording.labels_in(vocabulary).iter().any(Option::is_some))
            .collect();
        if labelled.is_empty() {
            return Err(PlanError::NoLabels {
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

    /// Starts training from what another run has learnt.
    ///
    /// # Errors
    /// When that run has seen somebody who is left out here. A checkpoint without a run's folder
    /// around it does not say whom it has seen.
    pub fn start_from(&mut self, start: &Path) -> Result<(), PlanError> {
        if let Ok(origin) = RunFolder::existing(start).and_then(|run| Self::load(&run)) {
            let seen = |subject: &&String| {
                matches!(
                    origin.split.role(subject),
                    Some(Role::Training | Role::Validation)
                )
            };
            let subjects: Vec<String> = self.split.held_out.iter().filter(seen).cloned().collect();
            if !subjects.is_empty() {
                return Err(PlanError::Seen {
                    start: start.to_owned(),
                    subjects: subjects.join(", "),
                });
            }
        }
        self.start = Some(std::path::absolute(start).unwrap_or_else(|_| start.to_owned()));
        Ok(())
    }

    /// Writes the plan into a run's folder, the preset also as TOML.
    ///
    /// # Errors
    /// When the folder cannot be written.
    pub fn save(&self, run: &RunFolder) -> Result<(), RunError> {
        crate::execution::run_folder::write_whole(&run.file("preset.toml"), self.preset.to_toml().as_bytes())?;
        run.save_json(FILE, self)
    }

    /// Reads the plan of a run's folder.
    ///
    /// # Errors
    /// When the folder holds none.
    pub fn load(run: &RunFolder) -> Result<Self, RunError> {
        run.load_json(FILE)
    }

    /// Samples that labels of a data set are moved by.
    #[must_use]
    pub fn lag(&self, data_set: DataSet) -> usize {
        self.lags.get(&data_set).map_or(0, |lag| lag.samples)
    }

    /// Labels of a recording in the preset's vocabulary, moved by its data set's lag.
    #[must_use]
    pub fn moved_labels(&self, recording: &Recording) -> Vec<Option<Intent>> {
        lag::shifted(
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

    /// What is trained on.
    #[must_use]
    pub fn training(&self, library: &Library) -> Corpus {
        self.corpus(library, Role::Training)
    }

    /// What chooses the checkpoint.
    #[must_use]
    pub fn validation(&self, library: &Library) -> Corpus {
        self.corpus(library, Role::Validation)
    }

    /// Recordings of the subjects left out that have labels of the vocabulary.
    #[must_use]
    pub fn held_out<'a>(&self, library: &'a Library) -> Vec<&'a Recording> {
        let vocabulary = self.preset.vocabulary();
        let mut recordings = self.split.select(&library.recordings, Role::HeldOut);
        recordings.retain(|recording| recording.labels_in(vocabulary).iter().any(Option::is_some));
        recordings
    }

    /// Validation recordings that have labels of the vocabulary.
    #[must_use]
    pub fn validation_recordings<'a>(&self, library: &'a Library) -> Vec<&'a Recording> {
        let vocabulary = self.preset.vocabulary();
        let mut recordings = self.split.select(&library.recordings, Role::Validation);
        recordings.retain(|recording| recording.labels_in(vocabulary).iter().any(Option::is_some));
        recordings
    }

    /// Recordings of one data set joined in random order and rhythm, one a subject, labels moved
    /// by the lag.
    #[must_use]
    pub fn spliced(&self, recordings: &[&Recording], seconds: f64) -> Vec<Recording> {
        let vocabulary = self.preset.vocabulary();
        let Some(first) = recordings.first() else {
            return Vec::new();
        };
        let own: Vec<Recording> = recordings
            .iter()
            .map(|&recording| Recording {
                labels: recording.labels_in(vocabulary),
                samples: self.samples(recording),
                ..recording.clone()
            })
            .collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked with the preset"
        )]
        let options = SpliceOptions {
            samples: (seconds * f64::from(SAMPLE_RATE_HZ)) as usize,
            count: 1,
            lag_samples: self.lag(first.data_set),
            seed: self.preset.seed,
        };
        splice::splice(&own.iter().collect::<Vec<_>>(), &options)
    }

    fn corpus(&self, library: &Library, role: Role) -> Corpus {
        let vocabulary = self.preset.vocabulary();
        let mut by_set: BTreeMap<DataSet, Vec<&Recording>> = BTreeMap::new();
        for recording in self.split.select(&library.recordings, role) {
            by_set
                .entry(recording.data_set)
                .or_default()
                .push(recording);
        }
        let people = folds::subjects(by_set.values().flatten().copied());
        let most = people.values().map(Vec::len).max().unwrap_or(0);
        let mut streams = Vec::new();
        for (data_set, recordings) in &by_set {
            if self.preset.data.as_published {
                streams.extend(recordings.iter().map(|recording| {
                    Stream::new(self.samples(recording), self.moved_labels(recording))
                }));
            }
            if self.preset.data.spliced_seconds > 0.0 {
                let share = most as f64 / people[data_set].len() as f64;
                let seconds =
                    self.preset.data.spliced_seconds * share.powf(self.preset.data.balance);
                let spliced = self.spliced(recordings, seconds);
                streams.extend(
                    spliced
                        .into_iter()
                        .map(|joined| Stream::new(joined.samples, joined.labels)),
                );
            }
        }
        Corpus {
            vocabulary,
            streams,
        }
    }
}

/// Listed subjects, and for data sets without a listed one a share that the seed chooses.
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
                    reason = "a share of a count"
                )]
                counts.insert(data_set, wanted as usize);
            }
            chosen.extend(own);
        }
        (chosen, counts)
    };
    let (mut held_out, held_out_counts) = listed(&data.held_out, data.held_out_share);
    let (mut validation, validation_counts) = listed(&data.validation, data.validation_share);
    // One draw for both, so that nobody is drawn twice, and from those who have no role yet.
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
                LabelLag::Documented => Lag {
                    samples: documented,
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

/// Revision of the checkout that the program runs in.
fn git_revision() -> Option<String> {
    let output = std::process::Command::new("git")
        .args(["describe", "--always", "--dirty", "--abbrev=12"])
        .output()
        .ok()?;
    let revision = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| revision.trim().to_owned())
}
