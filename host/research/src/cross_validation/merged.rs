//! The scores of one contender under one aggregation mode and confidence gate, over all folds and seeds.

use std::collections::BTreeMap;

use myointent::evaluation::metric::event::latency::{self, LatencySummary};
use myointent::evaluation::metric::event::summary::Raised;
use myointent::evaluation::{LookAhead, Measure, Score};

use super::job::FoldScore;

/// A contender's scores under one aggregation mode and confidence gate: those of every fold, by seed.
pub(crate) struct Merged<'a> {
    /// The contender.
    pub(crate) model: &'a str,
    pub(crate) look_ahead: LookAhead,
    /// The gate of all classes but relax; none: the contender's own.
    pub(crate) entry_margin: Option<f32>,
    scores: Vec<(u64, &'a Score)>,
}

impl<'a> Merged<'a> {
    /// The scores of a contender under one mode and gate among all scores of its jobs, each with its seed.
    pub(crate) fn new(
        model: &'a str,
        look_ahead: LookAhead,
        entry_margin: Option<f32>,
        scores: impl IntoIterator<Item = (u64, &'a FoldScore)>,
    ) -> Self {
        let scores = scores.into_iter();
        Self {
            model,
            look_ahead,
            entry_margin,
            scores: scores
                .filter(|(_, own)| own.entry_margin == entry_margin)
                .map(|(seed, own)| (seed, &own.score))
                .filter(|(_, score)| score.look_ahead == look_ahead)
                .collect(),
        }
    }

    /// Name in tables.
    pub(crate) fn name(&self) -> String {
        let gate = self.entry_margin.map(|margin| format!(", margin {margin}"));
        let gate = gate.unwrap_or_default();
        format!("{} ({}{gate})", self.model, self.look_ahead.name())
    }

    /// Whether the contender has not been evaluated so.
    pub(crate) const fn is_empty(&self) -> bool {
        self.scores.is_empty()
    }

    /// Scores with the seed of their job.
    pub(crate) fn scores(&self) -> impl Iterator<Item = (u64, &'a Score)> {
        self.scores.iter().copied()
    }

    /// A person's value, mean over seeds, of everybody of a data set who has one; of all if none.
    pub(crate) fn values(&self, measure: Measure, data_set: Option<&str>) -> Vec<(&'a str, f64)> {
        let mut by_person: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for (_, score) in &self.scores {
            for (person, value) in measure.values(score) {
                if data_set.is_none_or(|set| is_of(person, set)) {
                    by_person.entry(person).or_default().push(value);
                }
            }
        }
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        by_person
            .into_iter()
            .map(|(person, values)| (person, mean(values)))
            .collect()
    }

    /// Quantiles of the latency over the gestures of everybody of a data set, of all seeds.
    pub(crate) fn latency(&self, data_set: Option<&str>) -> Option<LatencySummary> {
        let (mut latencies, mut gestures) = (Vec::new(), 0);
        for events in self
            .scores
            .iter()
            .flat_map(|(_, score)| &score.events.subjects)
        {
            if data_set.is_none_or(|set| is_of(&events.subject, set)) {
                latencies.extend_from_slice(&events.latencies);
                gestures += events.gestures;
            }
        }
        latency::summary(&latencies, gestures)
    }

    /// Movements outside the vocabulary, of everybody and all seeds, by the name of their kind.
    pub(crate) fn raised(&self) -> BTreeMap<&'a str, Raised> {
        let mut by_kind: BTreeMap<&str, Raised> = BTreeMap::new();
        let people = self
            .scores
            .iter()
            .flat_map(|(_, score)| &score.events.subjects);
        for (kind, raised) in people.flat_map(|person| &person.raised) {
            let own = by_kind.entry(kind).or_default();
            *own = own.plus(*raised);
        }
        by_kind
    }

    /// The data sets of the people, in alphabetical order.
    pub(crate) fn data_sets(&self) -> Vec<&'a str> {
        let people = self
            .scores
            .iter()
            .flat_map(|(_, score)| &score.widest().subjects);
        let set = |subject: &'a str| subject.split_once('/').map_or(subject, |(set, _)| set);
        let mut sets: Vec<&str> = people.map(|person| set(&person.subject)).collect();
        sets.sort_unstable();
        sets.dedup();
        sets
    }
}

/// Whether a subject (`data-set/subject`) is of a data set.
fn is_of(subject: &str, data_set: &str) -> bool {
    subject
        .split_once('/')
        .is_some_and(|(set, _)| set == data_set)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::results::fixture::{results, score};

    /// The scores of one fold, `subject` with this accuracy.
    fn fold(people: &[(&str, f64, &[i32], usize)]) -> Vec<FoldScore> {
        let people = people
            .iter()
            .map(|&(subject, accuracy, offsets, gestures)| {
                score(subject, accuracy, offsets, gestures)
            });
        let mut scores = results(people, &[("m", true)]).published;
        // One truth, as a cross-validation keeps it.
        scores.truncate(scores.len() / 2);
        let several = scores
            .iter()
            .any(|score| score.data_set == myointent::evaluation::ALL);
        scores.retain(|score| !several || score.data_set == myointent::evaluation::ALL);
        let scores = scores.into_iter().map(|score| FoldScore {
            entry_margin: None,
            score,
        });
        scores.collect()
    }

    #[test]
    fn a_persons_value_is_the_mean_over_seeds_and_gestures_are_pooled() {
        let folds = [
            (
                1,
                fold(&[("x/a", 0.5, &[10], 2), ("y/b", 0.9, &[20, 40], 2)]),
            ),
            (2, fold(&[("x/a", 0.7, &[30, 30], 2)])),
            (2, fold(&[("y/b", 0.9, &[], 2)])),
        ];
        let scores = || {
            let folds = folds.iter();
            folds.flat_map(|(seed, scores)| scores.iter().map(|score| (*seed, score)))
        };
        let merged = Merged::new("p", LookAhead::AllRows, None, scores());
        assert_eq!(merged.name(), "p (0.25 s, all rows)");
        assert_eq!(merged.data_sets(), ["x", "y"]);
        let balanced = |set| merged.values(Measure::BalancedAccuracy, set);
        assert_eq!(balanced(None), [("x/a", 0.6), ("y/b", 0.9)]);
        assert_eq!(balanced(Some("y")), [("y/b", 0.9)]);
        // A mean of the seeds' shares, not a share of all gestures.
        let recognised = merged.values(Measure::Recognition, None);
        assert_eq!(recognised, [("x/a", 0.75), ("y/b", 0.5)]);
        // 10, 30, 30 samples of four gestures, 50 samples later; one is missed.
        let expected = latency::summary(&[60, 80, 80], 4);
        assert_eq!(merged.latency(Some("x")), expected);
        assert!(expected.is_some());
        let none = Merged::new("p", LookAhead::AllRows, Some(1.0), scores());
        assert_eq!(none.name(), "p (0.25 s, all rows, margin 1)");
        assert!(none.values(Measure::BalancedAccuracy, None).is_empty());
    }
}
