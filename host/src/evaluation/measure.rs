//! The measures of a score that have one value for each person.

use super::score::Score;
use crate::statistics::{Interval, MeanSd};

/// A measure with one value for each person.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Measure {
    /// Balanced accuracy.
    BalancedAccuracy,
    /// Transition accuracy with the widest buffer.
    TransitionAccuracy,
    /// Share of gestures recognised.
    Recognition,
    /// False activations a minute of rest.
    FalseActivations,
    /// Activations a minute of movement outside the vocabulary.
    OtherActivations,
    /// Label changes a minute beyond the true ones.
    Flicker,
    /// Raw accuracy.
    RawAccuracy,
}

impl Measure {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::BalancedAccuracy => "balanced",
            Self::TransitionAccuracy => "TA",
            Self::Recognition => "recognised",
            Self::FalseActivations => "false/min",
            Self::OtherActivations => "other/min",
            Self::Flicker => "flicker/min",
            Self::RawAccuracy => "raw",
        }
    }

    /// The value of each person who has one, in alphabetical order.
    #[must_use]
    pub fn values(self, score: &Score) -> Vec<(&str, f64)> {
        let scores = || score.widest().subjects.iter();
        let events = || score.events.subjects.iter();
        match self {
            Self::BalancedAccuracy => scores()
                .filter_map(|s| Some((s.subject.as_str(), s.balanced_accuracy?)))
                .collect(),
            Self::TransitionAccuracy => scores()
                .filter_map(|s| Some((s.subject.as_str(), s.transition_accuracy?)))
                .collect(),
            Self::RawAccuracy => scores()
                .filter_map(|s| Some((s.subject.as_str(), s.raw_accuracy?)))
                .collect(),
            Self::Recognition => events()
                .filter_map(|s| Some((s.subject.as_str(), s.recognition?)))
                .collect(),
            Self::FalseActivations => events()
                .filter_map(|s| Some((s.subject.as_str(), s.rest.per_minute()?)))
                .collect(),
            Self::OtherActivations => events()
                .filter_map(|s| Some((s.subject.as_str(), s.other_movement.per_minute()?)))
                .collect(),
            Self::Flicker => events()
                .filter_map(|s| Some((s.subject.as_str(), s.flicker.per_minute()?)))
                .collect(),
        }
    }

    /// Mean and deviation over people; none if nobody has a value.
    #[must_use]
    pub fn mean(self, score: &Score) -> Option<MeanSd> {
        MeanSd::of(&self.numbers(score))
    }

    /// 95 % interval of the mean, over people; none with fewer than two.
    #[must_use]
    pub fn interval(self, score: &Score) -> Option<Interval> {
        Interval::of_mean(&self.numbers(score))
    }

    fn numbers(self, score: &Score) -> Vec<f64> {
        let values = self.values(score).into_iter();
        values.map(|(_, value)| value).collect()
    }
}
