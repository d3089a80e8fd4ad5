//! The old model and the new one on what was held back, and the rule that chooses.

use shared::intent::Vocabulary;
use shared::model::file::Model;

use super::error::PersonalizeError;
use super::part::Part;
use crate::evaluation::{Candidate, LookAhead, Measure, Score, Trial, Truth, constant, score};
use crate::run::StepError;
use crate::run::candidates::integer_candidate;
use crate::run::model_evaluation::look_ahead;

/// Measures none of which may fall.
const RULE: [Measure; 3] = [
    Measure::BalancedAccuracy,
    Measure::TransitionAccuracy,
    Measure::Recognition,
];

/// Scores of a model file, `name` in tables, on a part of a person's recordings: integer arithmetic, its own look-ahead,
/// lag-compensated labels.
///
/// # Errors
/// When the model is refused.
pub fn judge(name: &str, file: &[u8], part: &Part<'_>) -> Result<Score, PersonalizeError> {
    let model = Model::parse(file)?;
    let trials = part.trials();
    let candidate = integer_candidate(name, &model, &trials)?;
    let look_ahead = look_ahead(&model.header.smoother);
    let vocabulary = model.header.dimensions.vocabulary;
    only(&candidate, &trials, vocabulary, look_ahead)
}

/// Scores of always saying relax.
///
/// # Errors
/// As [`judge`].
pub fn judge_constant(part: &Part<'_>, vocabulary: Vocabulary) -> Result<Score, PersonalizeError> {
    let trials = part.trials();
    only(&constant(&trials), &trials, vocabulary, LookAhead::None)
}

fn only(
    candidate: &Candidate,
    trials: &[Trial],
    vocabulary: Vocabulary,
    look_ahead: LookAhead,
) -> Result<Score, PersonalizeError> {
    let truth = Truth::LagCompensated;
    let mut scores = score(candidate, trials, vocabulary, look_ahead, truth)?;
    // One row: a person's recordings are of one data set.
    scores.pop().ok_or(StepError::NoTrials.into())
}

/// Whether a new model is not worse than an old one: neither balanced accuracy nor transition accuracy nor the share of
/// gestures recognised is lower.
#[must_use]
pub fn not_worse(old: &Score, new: &Score) -> bool {
    let value = |measure: Measure, score| measure.mean(score).map(|own| own.mean);
    RULE.into_iter()
        .all(|measure| match (value(measure, old), value(measure, new)) {
            (Some(old), Some(new)) => new >= old,
            (old, _) => old.is_none(),
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::Group;
    use crate::evaluation::metric::event::summary::{EventSummary, SubjectEvents};
    use crate::evaluation::metric::summary::{SubjectScore, Summary};

    /// A person's score of these three measures.
    fn scored([balanced, transition, recognition]: [Option<f64>; 3]) -> Score {
        let subject = SubjectScore {
            subject: "x/1".to_owned(),
            recordings: 1,
            classes: 3,
            balanced_accuracy: balanced,
            raw_accuracy: None,
            correct: 0,
            events: 0,
            transition_accuracy: transition,
            offsets: Vec::new(),
            offset: None,
        };
        let events = SubjectEvents {
            recognition,
            ..SubjectEvents::new("x/1", [])
        };
        let summary = Summary::of_subjects(vec![subject]);
        Score {
            model: "m".to_owned(),
            data_set: "x".to_owned(),
            classes: 3,
            people: Group::AllClasses,
            look_ahead: LookAhead::None,
            truth: Truth::LagCompensated,
            reference: std::array::from_fn(|_| summary.clone()),
            events: EventSummary::of_subjects(vec![events]),
        }
    }

    #[test]
    fn a_model_is_worse_if_any_of_three_measures_falls() {
        let old = [0.8, 0.5, 0.6].map(Some);
        let against_old = |new| not_worse(&scored(old), &scored(new));
        assert!(against_old(old));
        assert!(against_old([0.9, 0.5, 0.7].map(Some)));
        for fallen in 0..3 {
            let mut new = [0.9; 3].map(Some);
            new[fallen] = old[fallen].map(|value| value - 0.01);
            assert!(!against_old(new), "{fallen}");
            new[fallen] = None;
            assert!(!against_old(new), "{fallen}");
        }
    }

    #[test]
    fn a_measure_that_the_recordings_do_not_have_decides_nothing() {
        let old = scored([Some(0.8), None, None]);
        assert!(not_worse(&old, &scored([Some(0.8), None, None])));
        assert!(!not_worse(&old, &scored([Some(0.7), None, None])));
    }
}
