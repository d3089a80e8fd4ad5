//! The measures of a score that have one value for each person.

use super::metric::event::activation::DailyUse;
use super::metric::event::summary::SubjectEvents;
use super::metric::summary::{SubjectScore, Summary};
use super::score::Score;
use recordings::statistics::{Interval, MeanSd};

shared::names! {
    /// A measure with one value for each person.
    pub enum Measure {
        /// Balanced accuracy.
        BalancedAccuracy = "balanced",
        /// Balanced accuracy, each label at its emission time.
        BalancedAccuracyEmitted = "balanced emitted",
        /// Transition accuracy with the widest buffer.
        TransitionAccuracy = "TA",
        /// Transition accuracy with a buffer of 120 samples.
        TransitionAccuracyMiddle = "TA (120)",
        /// Transition accuracy with a buffer of 60 samples.
        TransitionAccuracyNarrow = "TA (60)",
        /// Transition accuracy with the widest buffer, each label at its emission time.
        TransitionAccuracyEmitted = "TA emitted",
        /// Share of gestures recognised.
        Recognition = "recognised",
        /// Share of gestures whose one decision is right, balanced over labels.
        Decided = "decided",
        /// Share of rest spans that stay at rest.
        RestKept = "rest kept",
        /// Share of gestures recognised within 100 ms of their onset.
        Within100 = "in 100 ms",
        /// Share of gestures recognised within 150 ms of their onset.
        Within150 = "in 150 ms",
        /// Share of gestures recognised within 200 ms of their onset.
        Within200 = "in 200 ms",
        /// Share of gestures recognised within 300 ms of their onset.
        Within300 = "in 300 ms",
        /// False activations a minute of rest.
        FalseActivations = "false/min",
        /// Activations a minute of movement outside the vocabulary.
        OtherActivations = "other/min",
        /// Share of movements outside the vocabulary that raise a label.
        Raised = "other raised",
        /// Activations a minute of daily life.
        DailyActivations = "daily/min",
        /// Share of daily life with an active label.
        DailyActive = "daily active",
        /// Label changes a minute beyond the true ones.
        Flicker = "flicker/min",
        /// Raw accuracy.
        RawAccuracy = "raw",
    }
}

impl Measure {
    /// The value of each person who has one, in alphabetical order.
    pub fn values<'a>(self, score: &'a Score) -> Vec<(&'a str, f64)> {
        let of_scores = |of: &'a Summary, value: fn(&SubjectScore) -> Option<f64>| {
            let subjects = of.subjects.iter();
            let values = subjects.filter_map(|own| Some((own.subject.as_str(), value(own)?)));
            values.collect()
        };
        let of_events = |value: fn(&SubjectEvents) -> Option<f64>| {
            let subjects = score.events.subjects.iter();
            let values = subjects.filter_map(|own| Some((own.subject.as_str(), value(own)?)));
            values.collect()
        };
        let balanced: fn(&SubjectScore) -> _ = |own| own.balanced_accuracy;
        let transitions: fn(&SubjectScore) -> _ = |own| own.transition_accuracy;
        match self {
            Self::BalancedAccuracy => of_scores(score.widest(), balanced),
            Self::BalancedAccuracyEmitted => of_scores(&score.emission, balanced),
            Self::TransitionAccuracy => of_scores(score.widest(), transitions),
            Self::TransitionAccuracyMiddle => of_scores(&score.reference[1], transitions),
            Self::TransitionAccuracyNarrow => of_scores(&score.reference[0], transitions),
            Self::TransitionAccuracyEmitted => of_scores(&score.emission, transitions),
            Self::RawAccuracy => of_scores(score.widest(), |own| own.raw_accuracy),
            Self::Recognition => of_events(|own| own.recognition),
            Self::Decided => of_events(SubjectEvents::decided),
            Self::RestKept => of_events(SubjectEvents::rest_kept),
            Self::Within100 => score.recognised_within(100),
            Self::Within150 => score.recognised_within(150),
            Self::Within200 => score.recognised_within(200),
            Self::Within300 => score.recognised_within(300),
            Self::FalseActivations => of_events(|own| own.rest.per_minute()),
            Self::OtherActivations => of_events(|own| own.other_movement.per_minute()),
            Self::Raised => of_events(SubjectEvents::raised_share),
            Self::DailyActivations => of_events(|own| own.daily_life()?.activations.per_minute()),
            Self::DailyActive => of_events(|own| own.daily_life().map(DailyUse::active_share)),
            Self::Flicker => of_events(|own| own.flicker.per_minute()),
        }
    }

    /// Mean and deviation over people; none if nobody has a value.
    pub fn mean(self, score: &Score) -> Option<MeanSd> {
        MeanSd::of(&self.numbers(score))
    }

    /// 95 % interval of the mean, over people; none with fewer than [`FEWEST`](recordings::statistics::FEWEST).
    pub fn interval(self, score: &Score) -> Option<Interval> {
        Interval::of_mean(&self.numbers(score))
    }

    fn numbers(self, score: &Score) -> Vec<f64> {
        let values = self.values(score).into_iter();
        values.map(|(_, value)| value).collect()
    }
}
