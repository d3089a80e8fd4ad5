//! The difference of two models, paired over people.
//!
//! People differ far more than models do. So the difference is taken person by person, and its interval is a
//! bootstrap over these differences ([`Interval::of_mean`]).

use super::measure::Measure;
use super::score::Score;
use crate::statistics::{Interval, MeanSd};

/// A difference of two models in one measure, over the people for whom both have a value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Difference {
    /// Mean and deviation of the differences.
    pub mean: MeanSd,
    /// 95 % interval of their mean; none for a single person.
    pub interval: Option<Interval>,
    /// Number of people.
    pub people: usize,
}

impl Difference {
    /// `score - other`; none if nobody has a value under both.
    #[must_use]
    pub fn of(measure: Measure, score: &Score, other: &Score) -> Option<Self> {
        let others = measure.values(other);
        let differences: Vec<f64> = measure
            .values(score)
            .into_iter()
            .filter_map(|(person, value)| {
                let (_, other) = others.iter().find(|(own, _)| *own == person)?;
                Some(value - other)
            })
            .collect();
        Some(Self {
            mean: MeanSd::of(&differences)?,
            interval: Interval::of_mean(&differences),
            people: differences.len(),
        })
    }

    /// Whether the interval excludes zero. One person shows no difference.
    #[must_use]
    pub fn is_shown(&self) -> bool {
        self.interval
            .is_some_and(|interval| !interval.contains(0.0))
    }
}
