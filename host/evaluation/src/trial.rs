//! A recording that models are evaluated on.

use shared::intent::Intent;
use shared::stream::preprocess::{Preprocessing, clean};
use shared::units::{CleanSample, Sample};

use recordings::{DataSet, Movement};

/// One recording that models are evaluated on.
#[derive(Clone, Debug)]
pub struct Trial {
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
    /// Labels as published; none for spliced recordings.
    pub published: Option<Vec<Option<Intent>>>,
    /// Lag-compensated labels.
    pub lag_compensated: Vec<Option<Intent>>,
    /// Movements outside the vocabulary, in which every gesture's label is wrong.
    pub other_movement: Vec<Movement>,
}

impl Trial {
    /// The input of a model.
    #[must_use]
    pub fn input(&self, preprocessing: Preprocessing) -> Vec<CleanSample> {
        let samples = if preprocessing.normalized {
            &self.normalized
        } else {
            &self.raw
        };
        clean(samples.iter().copied(), preprocessing.median).collect()
    }
}

#[cfg(any(test, feature = "testing"))]
impl Trial {
    /// A synthetic recording of a person for tests: 2 s of each class in turn.
    #[must_use]
    pub fn made_up(subject: &str, classes: &[usize]) -> Self {
        let labels = classes
            .iter()
            .flat_map(|&class| [Intent::from_class(class); 400]);
        let truth: Vec<Option<Intent>> = labels.collect();
        let emg = |label: &Option<Intent>| [if *label == Some(Intent::Relax) { 1 } else { 20 }; 8];
        Self {
            data_set: DataSet::Synthetic,
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
