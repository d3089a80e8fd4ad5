//! The measures of a score that have one value for each person.

use super::metric::summary::Summary;
use super::score::Score;
use recordings::statistics::{Interval, MeanSd};
use shared::units::SAMPLE_PERIOD_MS;

/// A measure with one value for each person.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Measure {
    /// Balanced accuracy.
    BalancedAccuracy,
    /// Balanced accuracy, each label at its emission time.
    BalancedAccuracyEmitted,
    /// Transition accuracy with the widest buffer.
    TransitionAccuracy,
    /// Transition accuracy with a buffer of 120 samples.
    TransitionAccuracyMiddle,
    /// Transition accuracy with a buffer of 60 samples.
    TransitionAccuracyNarrow,
    /// Transition accuracy with the widest buffer, each label at its emission time.
    TransitionAccuracyEmitted,
    /// Share of gestures recognised.
    Recognition,
    /// Share of gestures recognised within 100 ms of their onset.
    Within100,
    /// Share of gestures recognised within 150 ms of their onset.
    Within150,
    /// Share of gestures recognised within 200 ms of their onset.
    Within200,
    /// Share of gestures recognised within 300 ms of their onset.
    Within300,
    /// False activations a minute of rest.
    FalseActivations,
    /// Activations a minute of movement outside the vocabulary.
    OtherActivations,
    /// Share of movements outside the vocabulary that raise a label.
    Raised,
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
            Self::BalancedAccuracyEmitted => "balanced emitted",
            Self::TransitionAccuracy => "TA",
            Self::TransitionAccuracyMiddle => "TA (120)",
            Self::TransitionAccuracyNarrow => "TA (60)",
            Self::TransitionAccuracyEmitted => "TA emitted",
            Self::Recognition => "recognised",
            Self::Within100 => "in 100 ms",
            Self::Within150 => "in 150 ms",
            Self::Within200 => "in 200 ms",
            Self::Within300 => "in 300 ms",
            Self::FalseActivations => "false/min",
            Self::OtherActivations => "other/min",
            Self::Raised => "other raised",
            Self::Flicker => "flicker/min",
            Self::RawAccuracy => "raw",
        }
    }

    /// The value of each person who has one, in alphabetical order.
    #[must_use]
    pub fn values<'a>(self, score: &'a Score) -> Vec<(&'a str, f64)> {
        let scores = || score.widest().subjects.iter();
        let balanced = |of: &'a Summary| {
            let subjects = of.subjects.iter();
            let values = subjects.filter_map(|s| Some((s.subject.as_str(), s.balanced_accuracy?)));
            values.collect()
        };
        let transitions = |of: &'a Summary| {
            let subjects = of.subjects.iter();
            let values =
                subjects.filter_map(|s| Some((s.subject.as_str(), s.transition_accuracy?)));
            values.collect()
        };
        let events = || score.events.subjects.iter();
        let within = |ms: u32| {
            let samples = (ms / SAMPLE_PERIOD_MS) as i32;
            let shares = events().map(|s| (s.subject.as_str(), s.recognised_within(samples)));
            shares
                .filter_map(|(subject, share)| Some((subject, share?)))
                .collect()
        };
        match self {
            Self::BalancedAccuracy => balanced(score.widest()),
            Self::BalancedAccuracyEmitted => balanced(&score.emission),
            Self::TransitionAccuracy => transitions(score.widest()),
            Self::TransitionAccuracyMiddle => transitions(&score.reference[1]),
            Self::TransitionAccuracyNarrow => transitions(&score.reference[0]),
            Self::TransitionAccuracyEmitted => transitions(&score.emission),
            Self::Within100 => within(100),
            Self::Within150 => within(150),
            Self::Within200 => within(200),
            Self::Within300 => within(300),
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
            Self::Raised => events()
                .filter_map(|s| Some((s.subject.as_str(), s.raised_share()?)))
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

    /// 95 % interval of the mean, over people; none with fewer than [`FEWEST`](recordings::statistics::FEWEST).
    #[must_use]
    pub fn interval(self, score: &Score) -> Option<Interval> {
        Interval::of_mean(&self.numbers(score))
    }

    fn numbers(self, score: &Score) -> Vec<f64> {
        let values = self.values(score).into_iter();
        values.map(|(_, value)| value).collect()
    }
}
