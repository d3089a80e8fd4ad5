//! The streams that a run trains on and validates with.

use std::ops::Range;

use shared::intent::Intent;
use shared::units::SAMPLE_RATE_HZ;

use crate::config::ResolvedConfig;
use recordings::corpus::{Corpus, Stream};
use recordings::folds;
use recordings::splice::{self, SpliceOptions};
use recordings::split::Role;
use recordings::{Library, Recording, by_data_set};

impl ResolvedConfig {
    /// The streams of the training subjects.
    #[must_use]
    pub fn training(&self, library: &Library) -> Corpus {
        self.corpus(library, Role::Training)
    }

    /// The streams of the validation subjects, which select the checkpoint.
    #[must_use]
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

    /// Recordings of the subjects of a role that have labels of the vocabulary.
    pub fn labelled_recordings<'a>(&self, library: &'a Library, role: Role) -> Vec<&'a Recording> {
        let vocabulary = self.preset.vocabulary();
        let mut recordings = self.split.select(&library.recordings, role);
        recordings.retain(|recording| recording.has_labels_in(vocabulary));
        recordings
    }

    /// Spliced recordings, one per subject, with lag-compensated labels; the recordings given are those of one data
    /// set.
    pub fn spliced(&self, recordings: &[&Recording], seconds: f64, other: bool) -> Vec<Recording> {
        let vocabulary = self.preset.vocabulary();
        let own: Vec<Recording> = recordings
            .iter()
            .map(|&recording| {
                let compensated = recording.compensated(self.compensation(recording));
                Recording {
                    labels: compensated.labels_in(vocabulary),
                    other_movement: compensated.movement_outside(vocabulary),
                    samples: self.samples(recording),
                    ..compensated
                }
            })
            .collect();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the preset's check allows finite values from 0 on"
        )]
        let options = SpliceOptions {
            samples: (seconds * f64::from(SAMPLE_RATE_HZ)) as usize,
            count: 1,
            other,
            seed: self.preset.seed,
        };
        splice::splice(&own.iter().collect::<Vec<_>>(), &options)
    }

    /// Lag-compensated labels of a recording, in the preset's vocabulary, and where movement
    /// outside it has a target.
    fn training_labels(&self, recording: &Recording) -> (Vec<Option<Intent>>, Vec<Range<usize>>) {
        let vocabulary = self.preset.vocabulary();
        let compensated = recording.compensated(self.compensation(recording));
        let mut other_movement = Vec::new();
        if self.preset.other() {
            let movements = compensated.movement_outside(vocabulary).into_iter();
            other_movement.extend(movements.map(|movement| movement.samples));
        }
        (compensated.labels_in(vocabulary), other_movement)
    }

    fn corpus(&self, library: &Library, role: Role) -> Corpus {
        let vocabulary = self.preset.vocabulary();
        let data = &self.preset.data;
        let by_set = by_data_set(self.split.select(&library.recordings, role));
        let subjects = folds::subjects(by_set.values().flatten().copied());
        let most = subjects.values().map(Vec::len).max().unwrap_or(0);
        let mut streams = Vec::new();
        for (data_set, recordings) in &by_set {
            if data.as_published {
                streams.extend(recordings.iter().map(|recording| {
                    let (labels, other_movement) = self.training_labels(recording);
                    Stream {
                        other_movement,
                        ..Stream::new(self.samples(recording), labels)
                    }
                }));
            }
            if data.spliced_seconds > 0.0 {
                let ratio = most as f64 / subjects[data_set].len() as f64;
                let seconds = data.spliced_seconds * ratio.powf(data.balance);
                let spliced = self.spliced(recordings, seconds, self.preset.other());
                streams.extend(spliced.into_iter().map(Stream::from));
            }
        }
        let corpus = Corpus {
            vocabulary,
            other: self.preset.other(),
            streams,
        };
        corpus.with_median(data.median)
    }
}
