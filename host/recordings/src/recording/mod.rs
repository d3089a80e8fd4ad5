//! One recording.

pub mod daily_life;
pub mod movement;

use std::collections::BTreeMap;
use std::path::PathBuf;

use shared::intent::Intent;
use shared::stream::normalizer::Normalizer;
use shared::units::{SAMPLE_RATE_HZ, Sample};

use crate::catalogue::DataSet;
use crate::examiner::finding::Finding;
use movement::Movement;

/// Timing of a recording's labels.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Timing {
    /// Cues, or holds, without rest around them.
    #[default]
    Cues,
    /// Cues with rest around each gesture, so that the muscle shows when each was followed.
    RestAroundCues,
    /// The muscle's own activity: the labels are not late.
    Muscle,
}

/// Recordings of each data set, in their order.
pub fn by_data_set<'r>(
    recordings: impl IntoIterator<Item = &'r Recording>,
) -> BTreeMap<DataSet, Vec<&'r Recording>> {
    by(recordings, |own| own.data_set)
}

/// Items by a key of each, in their order.
pub(crate) fn by<T, K: Ord>(
    items: impl IntoIterator<Item = T>,
    key: impl Fn(&T) -> K,
) -> BTreeMap<K, Vec<T>> {
    let mut by_key: BTreeMap<K, Vec<T>> = BTreeMap::new();
    for item in items {
        by_key.entry(key(&item)).or_default().push(item);
    }
    by_key
}

/// One continuous stream of one person.
#[derive(Clone, PartialEq, Debug)]
pub struct Recording {
    /// The set that it was published in.
    pub data_set: DataSet,
    /// The person, unique over all data sets: `roshambo/03`, `ss-stm/sub7`, `cote-allard/E-Male3`.
    ///
    /// `cote-allard` numbers the people of its evaluation (`E-`) and pre-training (`P-`) parts
    /// apart and does not state whether somebody is in both: hold out whole parts where that matters.
    pub subject: String,
    /// Name within the subject.
    pub name: String,
    /// File of the samples.
    pub path: PathBuf,
    /// Raw samples as the armband sends them, 200 Hz.
    pub samples: Vec<Sample>,
    /// One label per sample in the six-class vocabulary; none where no intent of the six is known.
    pub labels: Vec<Option<Intent>>,
    /// Timing of the labels: cues, or the muscle's activity.
    pub timing: Timing,
    /// Movement that is none of the six intents (pointing, pronation, ...), in order, without labels, as late as the
    /// labels ([`DataSet::label_lag`]).
    ///
    /// Everything else without a label is unknown: it may be any movement, or rest.
    pub other_movement: Vec<Movement>,
    /// Known limits of the recording, a sentence each.
    pub notes: Vec<String>,
    /// Findings of the examiner.
    pub findings: Vec<Finding>,
    /// State of the wearer's normalization when the recording begins, from the person's recordings before it.
    pub wearer: Normalizer,
}

impl Recording {
    /// Samples of a person with a label each; without name, path, other movement and notes.
    pub fn new(
        data_set: DataSet,
        subject: impl Into<String>,
        samples: Vec<Sample>,
        labels: Vec<Option<Intent>>,
    ) -> Self {
        Self {
            data_set,
            subject: subject.into(),
            name: String::new(),
            path: PathBuf::new(),
            samples,
            labels,
            timing: Timing::default(),
            other_movement: Vec::new(),
            notes: Vec::new(),
            findings: Vec::new(),
            wearer: Normalizer::default(),
        }
    }

    /// Subject and name in one, as `myointent` prints it and takes it: `roshambo/03/session01`.
    pub fn full_name(&self) -> String {
        format!("{}/{}", self.subject, self.name)
    }

    /// The samples normalized to the wearer.
    pub fn normalized_samples(&self) -> Vec<Sample> {
        let mut wearer = self.wearer;
        let samples = self.samples.iter();
        samples.map(|&sample| wearer.push(sample)).collect()
    }

    /// Whether any sample has a label.
    pub fn has_labels(&self) -> bool {
        self.labels.iter().any(Option::is_some)
    }

    /// Duration in seconds.
    pub fn seconds(&self) -> f64 {
        self.samples.len() as f64 / f64::from(SAMPLE_RATE_HZ)
    }
}
