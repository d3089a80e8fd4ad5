//! Scores of one job, as kept in its run folder.

use serde::{Deserialize, Serialize};

use evaluation::Score;
use presets::OperatingPoint;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct JobScores {
    /// Scores on the fold's people.
    pub(crate) development: Vec<FoldScore>,
    /// Scores on the test people; none if these were not evaluated.
    pub(crate) test: Option<Vec<FoldScore>>,
}

/// Score over a group of people (with all classes or fewer), of a fold or of all test people.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FoldScore {
    /// Operating point; none for the contender's own.
    pub(crate) gate: Option<OperatingPoint>,
    pub(crate) score: Score,
}

impl JobScores {
    /// Selects the scores with these gates, on the test people if wanted; none if any are missing.
    pub(crate) fn complete(
        self,
        gates: &[Option<OperatingPoint>],
        test_people: bool,
    ) -> Option<Self> {
        let complete = |mut scores: Vec<FoldScore>| {
            let has = |gate: &Option<OperatingPoint>| {
                let mut scores = scores.iter();
                scores.any(|own| own.gate == *gate)
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
