//! The recordings that models are evaluated on, or that settings are chosen on.

use std::collections::BTreeMap;
use std::ops::Range;

use presets::config::ResolvedConfig;
use recordings::labels::compensation::Compensation;
use recordings::split::Role;
use recordings::{DataSet, Library, Movement, Recording};
use shared::intent::{Intent, Vocabulary};
use shared::stream::alignment::Alignment;
use shared::stream::preprocess::{Median, Preprocessing, clean};
use shared::units::{CleanSample, Sample};

/// One recording that models are evaluated on.
#[derive(Clone, Debug)]
pub struct EvaluatedRecording {
    /// Data set.
    pub data_set: DataSet,
    /// Subject.
    pub subject: String,
    /// Name of the recording.
    pub name: String,
    /// Samples as the armband sends them.
    pub raw: Vec<Sample>,
    /// Samples preprocessed as in the paper.
    pub emg: Vec<CleanSample>,
    /// Samples normalized to the wearer.
    pub normalized: Vec<Sample>,
    /// Labels as published, if there are any.
    pub published: Option<Vec<Option<Intent>>>,
    /// Lag-compensated labels.
    pub lag_compensated: Vec<Option<Intent>>,
    /// Movements outside the vocabulary, in which every gesture's label is wrong.
    pub other_movement: Vec<Movement>,
}

impl EvaluatedRecording {
    /// A recording with its samples as `arrange` changes them, and its labels in a vocabulary, compensated for their lag.
    ///
    /// Intents outside the vocabulary count as movement outside it.
    pub fn new(
        recording: &Recording,
        arrange: impl Fn(&mut Vec<Sample>),
        vocabulary: Vocabulary,
        compensation: Compensation,
    ) -> Self {
        let compensated = recording.compensated(compensation);
        let arranged = |mut samples: Vec<Sample>| {
            arrange(&mut samples);
            samples
        };
        let raw = arranged(recording.samples.clone());
        Self {
            data_set: recording.data_set,
            subject: recording.subject.clone(),
            name: recording.name.clone(),
            emg: clean(raw.iter().copied(), Median::Three).collect(),
            normalized: arranged(recording.normalized_samples()),
            raw,
            lag_compensated: compensated.labels_in(vocabulary),
            published: Some(recording.labels_in(vocabulary)),
            other_movement: compensated.movement_outside(vocabulary),
        }
    }

    /// The input of a model, aligned.
    pub fn input(&self, preprocessing: Preprocessing, alignment: Alignment) -> Vec<CleanSample> {
        let samples = if preprocessing.normalized {
            &self.normalized
        } else {
            &self.raw
        };
        clean(samples.iter().copied(), preprocessing.median)
            .map(|sample| alignment.apply(sample))
            .collect()
    }

    /// Removes labels: these samples are not scored.
    pub(crate) fn unlabel(&mut self, samples: Range<usize>) {
        if let Some(published) = &mut self.published {
            published[samples.clone()].fill(None);
        }
        self.lag_compensated[samples].fill(None);
    }

    /// Places of each person's recordings.
    pub(crate) fn places(recordings: &[Self]) -> BTreeMap<&str, Vec<usize>> {
        let mut places: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (at, recording) in recordings.iter().enumerate() {
            places.entry(&recording.subject).or_default().push(at);
        }
        places
    }

    /// Recordings of the people of a role, as published: models are evaluated on those held out, settings are chosen on those that
    /// validate, the floors of the tables are fitted to those that train.
    pub fn of_role(config: &ResolvedConfig, library: &Library, role: Role) -> Vec<Self> {
        let vocabulary = config.preset.vocabulary();
        config
            .evaluated_recordings(library, role)
            .into_iter()
            .map(|recording| {
                let compensation = config.compensation(recording);
                let align = |samples: &mut Vec<Sample>| config.align(recording, samples);
                Self::new(recording, align, vocabulary, compensation)
            })
            .collect()
    }
}

#[cfg(any(test, feature = "testing"))]
impl EvaluatedRecording {
    /// A synthetic recording of a person for tests: 2 s of each class in turn.
    pub fn made_up(subject: &str, classes: &[usize]) -> Self {
        let labels = classes
            .iter()
            .flat_map(|&class| [Intent::from_class(class); 400]);
        let truth: Vec<Option<Intent>> = labels.collect();
        let emg = |label: &Option<Intent>| [if *label == Some(Intent::Relax) { 1 } else { 20 }; 8];
        Self {
            data_set: DataSet::SYNTHETIC,
            subject: subject.to_owned(),
            name: "r".to_owned(),
            raw: Vec::new(),
            emg: truth.iter().map(emg).collect(),
            normalized: Vec::new(),
            published: Some(truth.clone()),
            lag_compensated: truth,
            other_movement: Vec::new(),
        }
    }
}
