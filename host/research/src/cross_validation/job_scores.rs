//! The scores of one job, as its run folder keeps them.

use serde::{Deserialize, Serialize};

use evaluation::{LookAhead, Score};

use super::gate::Gate;

/// The scores of a job.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct JobScores {
    /// Scores on the fold's people.
    pub(crate) development: Vec<FoldScore>,
    /// Scores on the test people; none if nobody has looked at them.
    pub(crate) test: Option<Vec<FoldScore>>,
}

/// A score over all people of a fold, or over all test people, who have all classes or fewer.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FoldScore {
    /// Confidence gate; none: the contender's own.
    pub(crate) gate: Option<Gate>,
    /// The score.
    pub(crate) score: Score,
}

impl JobScores {
    /// The scores with these gates alone, and on the test people and without look-ahead if they are wanted; none if any are
    /// missing.
    pub(crate) fn complete(
        self,
        gates: &[Option<Gate>],
        test_people: bool,
        without_look_ahead: bool,
    ) -> Option<Self> {
        let complete = |mut scores: Vec<FoldScore>| {
            let counts =
                |own: &FoldScore| !without_look_ahead || own.score.look_ahead == LookAhead::None;
            let has = |gate: &Option<Gate>| {
                let mut scores = scores.iter();
                scores.any(|own| own.gate == *gate && counts(own))
            };
            let all = gates.iter().all(has);
            scores.retain(|own| gates.contains(&own.gate));
            all.then_some(scores)
        };
        let test = if test_people {
            Some(complete(self.test?)?)
        } else {
            None
        };
        Some(Self {
            development: complete(self.development)?,
            test,
        })
    }
}
