//! Daily life: recordings of people who use their hands and mean no gesture. Any label is one too many.

use shared::intent::Vocabulary;
use shared::units::Sample;

use super::Recording;
use crate::labels::activity::{Activity, activity};

shared::names! {
    /// Kind of a daily activity.
    pub enum DailyKind {
        /// Typing on a keyboard.
        Typing = "typing",
        /// Writing by hand.
        Writing = "writing",
        /// Use of a phone.
        Phone = "phone",
        /// Walking.
        Walking = "walking",
        /// Eating.
        Eating = "eating",
        /// Signing: words and letters of a sign language.
        Signing = "signing",
        /// Any other activity.
        Other = "daily-life",
    }
}

impl Recording {
    /// Whether a training can learn from the recording: it has labels of a vocabulary, or is daily life.
    pub fn teaches(&self, vocabulary: Vocabulary) -> bool {
        self.is_daily_life() || self.has_labels_in(vocabulary)
    }

    /// Whether any part of the recording is daily life.
    pub fn is_daily_life(&self) -> bool {
        let mut movements = self.other_movement.iter();
        movements.any(|own| own.kind.is_daily())
    }
}

/// Flags of the samples that are quiet: a label of relax is certain there, whatever the person does.
///
/// Nothing is quiet where the muscles are always, or never, active.
pub fn quiet(samples: &[Sample]) -> Vec<bool> {
    activity(samples).map_or_else(
        || vec![false; samples.len()],
        |activity| activity.iter().map(|own| *own == Activity::Quiet).collect(),
    )
}
