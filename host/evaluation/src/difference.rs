//! The difference of two models, paired over people.
//!
//! People differ far more than models do. So the difference is taken person by person, and its interval is a
//! bootstrap over these differences ([`Interval::of_mean`]).

use super::measure::Measure;
use super::score::Score;
use recordings::statistics::{Interval, MeanSd};

/// A difference of two models in one measure, over the people for whom both have a value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Difference {
    /// Mean and deviation of the differences, with the number of people.
    pub mean: MeanSd,
    /// 95 % interval of their mean; none for fewer than [`FEWEST`](recordings::statistics::FEWEST) people.
    pub interval: Option<Interval>,
}

impl Difference {
    /// Difference `score - other` of a measure; none if nobody has a value under both.
    pub fn of(measure: Measure, score: &Score, other: &Score) -> Option<Self> {
        Self::paired(&measure.values(score), &measure.values(other))
    }

    /// Differences of the people who have a value in both lists, each list with a person once.
    pub fn paired(values: &[(&str, f64)], others: &[(&str, f64)]) -> Option<Self> {
        let differences: Vec<f64> = values
            .iter()
            .filter_map(|(person, value)| {
                let (_, other) = others.iter().find(|(own, _)| own == person)?;
                Some(value - other)
            })
            .collect();
        Some(Self {
            mean: MeanSd::of(&differences)?,
            interval: Interval::of_mean(&differences),
        })
    }

    /// Whether there is an interval, and it excludes zero.
    pub fn is_shown(&self) -> bool {
        self.interval
            .is_some_and(|interval| !interval.contains(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::summary::SubjectScore;

    /// A score with these balanced accuracies, by person.
    fn score(people: &[(usize, f64)]) -> Score {
        let subject = |&(who, balanced): &(usize, f64)| SubjectScore {
            subject: format!("x/{who}"),
            balanced_accuracy: Some(balanced),
            ..SubjectScore::default()
        };
        Score::of_people(people.iter().map(subject).collect(), Vec::new())
    }

    fn difference(model: &[(usize, f64)], other: &[(usize, f64)]) -> Option<Difference> {
        Difference::of(Measure::BalancedAccuracy, &score(model), &score(other))
    }

    #[test]
    fn a_small_difference_that_everybody_has_is_shown_and_a_mixed_one_is_not() {
        let other = [(1, 0.3), (2, 0.6), (3, 0.9), (4, 0.5), (5, 0.7), (6, 0.8)];
        let better = other.map(|(who, value)| (who, value + 0.01 * who as f64));
        let found = difference(&better, &other).unwrap();
        assert!(found.is_shown() && (found.mean.mean - 0.035).abs() < 1e-12);
        assert!(!difference(&better[..5], &other).unwrap().is_shown());
        let mixed = [(1, 0.5), (2, 0.5), (3, 0.95), (4, 0.48), (5, 0.7), (6, 0.7)];
        assert!(!difference(&mixed, &other).unwrap().is_shown());
        // Only the people whom both have count.
        let alone = difference(&[(1, 0.9), (7, 0.0)], &other).unwrap();
        assert_eq!(alone.mean.mean, 0.9 - 0.3);
        assert_eq!((alone.mean.n, alone.is_shown()), (1, false));
        assert_eq!(difference(&[(7, 0.9)], &other), None);
        let equal = difference(&other, &other).unwrap();
        assert!(!equal.is_shown());
    }
}
