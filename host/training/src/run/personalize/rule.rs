//! Rule that chooses between the old model and the new one.

use serde::Serialize;
use thiserror::Error;

use evaluation::metric::event::activation::Rate;
use evaluation::metric::event::summary::{SubjectEvents, Tally};
use evaluation::{Measure, Score};

/// Measures that must not fall.
const NEVER_LOWER: [(Measure, Fallen); 3] = [
    (Measure::BalancedAccuracy, Fallen::BalancedAccuracy),
    (Measure::TransitionAccuracy, Fallen::TransitionAccuracy),
    (Measure::Recognition, Fallen::Recognised),
];
/// Gain of balanced accuracy over always saying relax that a model needs.
const ABOVE_CONSTANT: f64 = 0.2;
/// Additional false activations a minute of rest that are allowed.
const MORE_AT_REST: f64 = 2.0;
/// Additional share of other movements that may raise a label.
const MORE_RAISED: f64 = 0.1;

/// Measure that has fallen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Error)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Fallen {
    #[error("balanced accuracy")]
    BalancedAccuracy,
    #[error("transition accuracy")]
    TransitionAccuracy,
    #[error("the share of gestures recognised")]
    Recognised,
}

/// Why the new model is not written.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Worse {
    #[error(
        "the tuned model is hardly better than always saying relax: its balanced accuracy is {found:.3}, always relax has {constant:.3}, at least {least:.3} is needed; look at the recordings with `myointent data inspect`, above all at their scale, at hum and at the labels"
    )]
    Constant {
        found: f64,
        constant: f64,
        least: f64,
    },
    #[error("{measure} fell from {old:.3} to {new:.3}")]
    Lower { measure: Fallen, old: f64, new: f64 },
    #[error(
        "false activations at rest rose from {old:.1} to {new:.1} a minute, expected at most {allowed} more"
    )]
    Rest { old: f64, new: f64, allowed: f64 },
    #[error(
        "activations in other movement rose from {old:.1} to {new:.1} a minute, expected at most a tenth more"
    )]
    OtherRate { old: f64, new: f64 },
    #[error(
        "{new} of {movements} other movements raise a label, {old} did before; expected at most a tenth of them more"
    )]
    Other {
        movements: usize,
        old: usize,
        new: usize,
    },
}

/// Reason why a new model is worse than an old one; none if it may replace it.
///
/// It is not worse if it is better than always saying relax by [`ABOVE_CONSTANT`] of balanced accuracy, if neither balanced
/// accuracy nor transition accuracy nor the share of gestures recognised is lower, and if it raises few more labels: 2 a
/// minute of rest, for a tenth of the other movements, and a tenth more in their time. The part held back is short, so a single label must not decide.
pub(super) fn worse(old: &Score, new: &Score, constant: &Score) -> Option<Worse> {
    if is_constant(new, constant) {
        return Some(Worse::Constant {
            found: balanced(new),
            constant: balanced(constant),
            least: balanced(constant) + ABOVE_CONSTANT,
        });
    }
    let lower = NEVER_LOWER.into_iter().find_map(|(measure, fallen)| {
        let old = value(measure, old)?;
        let new = value(measure, new).unwrap_or(0.0);
        (new < old).then_some(Worse::Lower {
            measure: fallen,
            old,
            new,
        })
    });
    lower
        .or_else(|| more_at_rest(old, new))
        .or_else(|| more_raised(old, new))
        .or_else(|| more_in_others(old, new))
}

/// Whether a model is hardly better than always saying relax: by less than [`ABOVE_CONSTANT`] of balanced accuracy.
pub(crate) fn is_constant(model: &Score, constant: &Score) -> bool {
    balanced(model) < balanced(constant) + ABOVE_CONSTANT
}

fn balanced(score: &Score) -> f64 {
    value(Measure::BalancedAccuracy, score).unwrap_or(0.0)
}

fn value(measure: Measure, score: &Score) -> Option<f64> {
    measure.mean(score).map(|own| own.mean)
}

/// Activations of all subjects, in rest or in other movement.
pub(super) fn rate(score: &Score, of: fn(&SubjectEvents) -> Rate) -> Rate {
    let subjects = score.events.subjects.iter();
    subjects.fold(Rate::default(), |sum, own| sum.plus(of(own)))
}

fn more_in_others(old: &Score, new: &Score) -> Option<Worse> {
    let [before, after] = [old, new].map(|score| rate(score, |own| own.other_movement));
    let (old, new) = (before.per_minute()?, after.per_minute()?);
    let is_worse = after.count > before.count + 1 && new > old * (1.0 + MORE_RAISED);
    is_worse.then_some(Worse::OtherRate { old, new })
}

fn more_at_rest(old: &Score, new: &Score) -> Option<Worse> {
    let [before, after] = [old, new].map(|score| rate(score, |own| own.rest));
    let (old, new) = (before.per_minute()?, after.per_minute()?);
    let is_worse = after.count > before.count + 1 && new > old + MORE_AT_REST;
    let allowed = MORE_AT_REST;
    is_worse.then_some(Worse::Rest { old, new, allowed })
}

fn more_raised(old: &Score, new: &Score) -> Option<Worse> {
    let [before, after] = [old, new].map(|score| {
        let subjects = score.events.subjects.iter();
        let kinds = subjects.flat_map(|own| own.raised.values().copied());
        kinds.fold(Tally::default(), Tally::plus)
    });
    let (movements, old, new) = (after.all, before.counted, after.counted);
    let is_worse = new > old + 1 && (new - old) as f64 > MORE_RAISED * movements as f64;
    is_worse.then_some(Worse::Other {
        movements,
        old,
        new,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use evaluation::metric::summary::SubjectScore;

    /// Values that make a score in these tests.
    #[derive(Clone)]
    struct Scored {
        /// Balanced accuracy, transition accuracy, and share recognised.
        measures: [Option<f64>; 3],
        /// Number of false activations in a minute of rest.
        rest: usize,
        /// Number of activations in a minute of other movement.
        others: usize,
        /// Number of twenty other movements that raise a label; none if there is no other movement.
        raised: Option<usize>,
    }

    impl Scored {
        const fn of(measures: [Option<f64>; 3]) -> Self {
            Self {
                measures,
                rest: 0,
                others: 0,
                raised: None,
            }
        }

        fn score(&self) -> Score {
            let [balanced_accuracy, transition_accuracy, recognition] = self.measures;
            let subject = SubjectScore {
                subject: "x/1".to_owned(),
                balanced_accuracy,
                transition_accuracy,
                ..SubjectScore::default()
            };
            let raised = self.raised.map(|counted| {
                let of = Tally { all: 20, counted };
                ("other".to_owned(), of)
            });
            let in_a_minute = |count| Rate {
                count,
                seconds: 60.0,
            };
            let events = SubjectEvents {
                recognition,
                rest: in_a_minute(self.rest),
                other_movement: in_a_minute(self.others),
                raised: raised.into_iter().collect(),
                ..SubjectEvents::new("x/1", [])
            };
            Score::of_people(vec![subject], vec![events])
        }
    }

    /// Reason why the new model is worse, where always saying relax has a third.
    fn found(old: &Scored, new: &Scored) -> Option<Worse> {
        let constant = Scored::of([Some(1.0 / 3.0), Some(0.0), Some(0.0)]);
        worse(&old.score(), &new.score(), &constant.score())
    }

    #[test]
    fn a_model_is_worse_if_any_of_three_measures_falls() {
        let old = [0.8, 0.5, 0.6].map(Some);
        let against_old = |new| found(&Scored::of(old), &Scored::of(new));
        assert_eq!(against_old(old), None);
        assert_eq!(against_old([0.9, 0.5, 0.7].map(Some)), None);
        for fallen in 0..3 {
            let mut new = [0.9; 3].map(Some);
            new[fallen] = old[fallen].map(|value| value - 0.01);
            let why = against_old(new);
            assert!(
                matches!(why, Some(Worse::Lower { .. })),
                "{fallen}: {why:?}"
            );
            new[fallen] = None;
            assert!(against_old(new).is_some(), "{fallen}");
        }
    }

    #[test]
    fn a_measure_that_the_recordings_do_not_have_decides_nothing() {
        let old = Scored::of([Some(0.8), None, None]);
        assert_eq!(found(&old, &old), None);
        assert!(found(&old, &Scored::of([Some(0.7), None, None])).is_some());
    }

    #[test]
    fn whatever_the_old_model_has_a_new_one_near_a_constant_is_refused() {
        for balanced in [None, Some(0.0), Some(1.0 / 3.0), Some(0.53)] {
            let new = Scored::of([balanced, Some(1.0), Some(1.0)]);
            let old = Scored::of([balanced, Some(0.0), Some(0.0)]);
            let why = found(&old, &new);
            assert!(matches!(why, Some(Worse::Constant { .. })), "{why:?}");
        }
        let [old, new] = [0.31, 0.54].map(|own| Scored::of([own, 0.0, 0.0].map(Some)));
        assert_eq!(found(&old, &new), None);
    }

    #[test]
    fn more_labels_at_rest_or_in_other_movement_than_stated_are_worse() {
        let with = |rest, raised| Scored {
            rest,
            raised,
            ..Scored::of([0.8, 0.5, 0.6].map(Some))
        };
        assert_eq!(found(&with(0, None), &with(2, None)), None);
        let (old, new, allowed) = (0.0, 3.0, 2.0);
        let rest = Some(Worse::Rest { old, new, allowed });
        assert_eq!(found(&with(0, None), &with(3, None)), rest);
        assert_eq!(found(&with(3, None), &with(0, None)), None);
        assert_eq!(found(&with(0, Some(8)), &with(0, Some(10))), None);
        let other = found(&with(0, Some(8)), &with(0, Some(11)));
        let is_told = matches!(
            other,
            Some(Worse::Other {
                movements: 20,
                old: 8,
                new: 11
            })
        );
        assert!(is_told, "{other:?}");
        assert_eq!(found(&with(0, Some(20)), &with(0, Some(0))), None);
    }

    #[test]
    fn more_activations_in_a_long_other_movement_are_worse() {
        let with = |others| Scored {
            others,
            ..Scored::of([0.8, 0.5, 0.6].map(Some))
        };
        for (old, new) in [(0, 1), (20, 22), (20, 0)] {
            assert_eq!(found(&with(old), &with(new)), None, "{old} {new}");
        }
        let why = found(&with(20), &with(23));
        let (old, new) = (20.0, 23.0);
        assert_eq!(why, Some(Worse::OtherRate { old, new }));
    }
}
