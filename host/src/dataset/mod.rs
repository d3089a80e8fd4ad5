//! Recordings of muscle activity and their labels: read, checked, divided by person, cut and
//! joined.
//!
//! One reader per published format ([`load`] finds out which by looking at the files). Labels are
//! the cue that the person saw, not the muscle: [`lag`] measures how much later the muscle comes.
//! Nothing here resamples, filters or scales a sample.

pub mod corpus;
mod cote_allard;
mod emg_epn;
mod error;
pub mod folds;
pub mod inspection;
pub mod label_file;
pub mod lag;
pub mod lead_in;
mod library;
mod myo_readings;
pub mod npy;
mod one_subject_myo;
mod react_emg;
mod roshambo;
mod runs;
pub mod splice;
pub mod split;
mod ss_stm;
pub mod synthetic;
mod table;

use std::path::PathBuf;

use shared::intent::{Intent, Vocabulary};
use shared::units::{CHANNELS, SAMPLE_RATE_HZ, Sample};

pub use error::{Fault, LoadError, Place, Remedy};
pub use library::{Library, LoadOptions, Repeat, Skipped, load};
pub use runs::{Run, runs};

/// A published set of recordings, or a kind of file.
#[derive(
    Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum DataSet {
    /// Donati, *EMG from forearm datasets for hand gestures recognition*, 2019.
    Roshambo,
    /// Kanoga et al., semi-supervised style transfer mapping, 2021.
    SsStm,
    /// Cote-Allard et al., transfer learning, 2019.
    CoteAllard,
    /// Francic et al., myo-readings-dataset, 2021.
    MyoReadings,
    /// Eddy et al., LibEMG's demonstration set, 2023.
    OneSubjectMyo,
    /// Benalcazar et al., EMG-EPN-612, 2020.
    #[serde(rename = "emg-epn-612")]
    EmgEpn612,
    /// ROAM-EMG and whatever else lies in ReactEMG's csv or npy layout.
    ReactEmg,
    /// Made by [`synthetic`], not by a muscle.
    Synthetic,
}

impl DataSet {
    /// Name in subjects (`roshambo/03`), tables and presets.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Roshambo => "roshambo",
            Self::SsStm => "ss-stm",
            Self::CoteAllard => "cote-allard",
            Self::MyoReadings => "myo-readings",
            Self::OneSubjectMyo => "one-subject-myo",
            Self::EmgEpn612 => "emg-epn-612",
            Self::ReactEmg => "react-emg",
            Self::Synthetic => "synthetic",
        }
    }

    /// How much later than its label the muscle usually acts, in samples.
    ///
    /// Nominal: [`lag::estimate`] over all subjects of the copy at hand. Training measures it anew
    /// on its own training subjects; this is what remains when none of them has a transition.
    /// Sets of steady holds have no transition to be late at; EMG-EPN-612 and ROAM-EMG were
    /// segmented by their authors and count as 0.
    #[must_use]
    pub const fn label_lag(self) -> usize {
        match self {
            Self::Roshambo => 62,
            Self::SsStm => 145,
            Self::MyoReadings => 54,
            Self::Synthetic => 50,
            Self::CoteAllard | Self::OneSubjectMyo | Self::EmgEpn612 | Self::ReactEmg => 0,
        }
    }

    /// Places that the electrodes must be turned by, up the ring, for the set to lie in the common frame:
    /// wrist extension is strongest on the third channel there, as in `ss-stm` and `myo-readings`.
    ///
    /// `cote-allard` has it on the second, `one-subject-myo` on the fourth. `roshambo` records no
    /// extension; its pattern of open against close agrees best with `cote-allard`'s turned by this
    /// one place (mean correlation over pairs of people 0.35, 0.12 as recorded).
    #[must_use]
    pub const fn electrode_turn(self) -> usize {
        match self {
            Self::CoteAllard => 1,
            Self::OneSubjectMyo => CHANNELS - 1,
            _ => 0,
        }
    }

    /// Whether rest that follows a gesture may still hold the gesture until its end.
    ///
    /// `ss-stm` has nominal times only and its gestures are let go up to 1.5 s late.
    const fn releases_at_unknown_times(self) -> bool {
        matches!(self, Self::SsStm)
    }
}

/// One continuous stream of one person.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Recording {
    /// Where it comes from.
    pub data_set: DataSet,
    /// The person, unique over all data sets: `roshambo/03`, `ss-stm/sub7`, `cote-allard/E-Male3`.
    ///
    /// `cote-allard` numbers the people of its evaluation (`E-`) and pre-training (`P-`) parts
    /// apart and does not say whether somebody is in both: hold out whole parts where that matters.
    pub subject: String,
    /// Name within the subject.
    pub name: String,
    /// File of the samples.
    pub path: PathBuf,
    /// Raw samples as the armband sends them, 200 Hz.
    pub samples: Vec<Sample>,
    /// One label per sample in the six-class vocabulary; none where no intent of the six is known.
    pub labels: Vec<Option<Intent>>,
    /// What a reader should know before trusting it, a sentence each.
    pub notes: Vec<String>,
}

impl Recording {
    /// Whether any sample has a label.
    #[must_use]
    pub fn has_labels(&self) -> bool {
        self.labels.iter().any(Option::is_some)
    }

    /// The samples with the electrodes turned into the common frame ([`DataSet::electrode_turn`]).
    #[must_use]
    pub fn aligned_samples(&self) -> Vec<Sample> {
        let turn = self.data_set.electrode_turn();
        let turned = |mut sample: Sample| {
            sample.rotate_right(turn);
            sample
        };
        self.samples.iter().copied().map(turned).collect()
    }

    /// Duration in seconds.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.samples.len() as f64 / f64::from(SAMPLE_RATE_HZ)
    }

    /// The labels in a vocabulary: intents outside it become none, never a wrong label.
    ///
    /// Where a set's gestures end at unknown times, the rest after such an intent becomes none too.
    #[must_use]
    pub fn labels_in(&self, vocabulary: Vocabulary) -> Vec<Option<Intent>> {
        let mut labels = self.labels.clone();
        let mut doubtful = false;
        for run in runs(&self.labels) {
            let outside = run.label.is_some_and(|intent| !vocabulary.contains(intent));
            let after = doubtful && run.label == Some(Intent::Relax);
            if outside || after {
                labels[run.start..run.end].fill(None);
            }
            doubtful = outside && self.data_set.releases_at_unknown_times();
        }
        labels
    }
}
