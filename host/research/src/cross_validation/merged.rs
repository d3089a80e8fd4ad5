//! Scores of one contender under one aggregation mode and operating point, over all folds and seeds.

use std::collections::{BTreeMap, BTreeSet};

use evaluation::metric::event::activation::DailyUse;
use evaluation::metric::event::latency::{self, LatencySummary};
use evaluation::metric::event::summary::{SubjectEvents, Tally};
use evaluation::{Group, LookAhead, Measure, Score};
use presets::OperatingPoint;
use recordings::statistics::MeanSd;

use super::job::FoldScore;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    pub(crate) seed: u64,
    pub(crate) fold: usize,
}

/// People of a row: those of a data set (none for all), with all classes or with fewer.
pub(crate) type Section<'a> = (Option<&'a str>, Group);

/// Scores of a contender under one aggregation mode and operating point, of every fold and seed.
pub(crate) struct Merged<'a> {
    pub(crate) model: &'a str,
    pub(crate) look_ahead: LookAhead,
    /// Operating point; none for the contender's own.
    pub(crate) gate: Option<OperatingPoint>,
    scores: Vec<(Origin, &'a Score)>,
}

impl<'a> Merged<'a> {
    /// Selects the scores of a contender under one mode and gate from all scores of its jobs, each with its origin.
    pub(crate) fn new(
        model: &'a str,
        look_ahead: LookAhead,
        gate: Option<OperatingPoint>,
        scores: impl IntoIterator<Item = (Origin, &'a FoldScore)>,
    ) -> Self {
        let scores = scores.into_iter();
        Self {
            model,
            look_ahead,
            gate,
            scores: scores
                .filter(|(_, own)| own.gate == gate)
                .map(|(origin, own)| (origin, &own.score))
                .filter(|(_, score)| score.look_ahead == look_ahead)
                .collect(),
        }
    }

    /// Name in tables.
    pub(crate) fn name(&self) -> String {
        format!(
            "{} ({}{})",
            self.model,
            self.look_ahead.name(),
            self.margin()
        )
    }

    /// Name in pictures: without the look-ahead.
    pub(crate) fn short_name(&self) -> String {
        format!("{}{}", self.model, self.margin())
    }

    /// End of a name: the operating point, unless it is the contender's own.
    fn margin(&self) -> String {
        self.gate
            .map_or_else(String::new, |gate| format!(", {gate}"))
    }

    pub(crate) fn classes(&self) -> usize {
        self.scores.first().map_or(0, |(_, score)| score.classes)
    }

    /// Whether the contender was not evaluated under this mode and gate.
    pub(crate) const fn is_empty(&self) -> bool {
        self.scores.is_empty()
    }

    pub(crate) fn scores(&self) -> impl Iterator<Item = (Origin, &'a Score)> {
        self.scores.iter().copied()
    }

    fn of_group(&self, group: Group) -> impl Iterator<Item = &'a Score> {
        let scores = self.scores.iter().map(|(_, score)| *score);
        scores.filter(move |score| score.people == group)
    }

    pub(crate) fn people(&self, (data_set, group): Section<'_>) -> BTreeSet<&'a str> {
        let subjects = self
            .of_group(group)
            .flat_map(|score| &score.widest().subjects);
        let people = subjects.map(|own| &own.subject[..]);
        people
            .filter(|person| data_set.is_none_or(|set| is_of(person, set)))
            .collect()
    }

    /// Values of the people of a section, where they have one: each is the mean over the jobs that evaluate the person.
    pub(crate) fn values(&self, measure: Measure, section: Section<'_>) -> Vec<(&'a str, f64)> {
        self.means(section, |score| measure.values(score))
    }

    /// The same values without the people's names.
    pub(crate) fn numbers(&self, measure: Measure, section: Section<'_>) -> Vec<f64> {
        let values = self.values(measure, section).into_iter();
        values.map(|(_, value)| value).collect()
    }

    /// Share of gestures recognised within `ms` milliseconds after their onset: the mean over a section's people; `None`
    /// if nobody makes gestures.
    pub(crate) fn recognised_within(&self, ms: u32, section: Section<'_>) -> Option<f64> {
        let shares = self.means(section, |score| score.recognised_within(ms));
        let shares: Vec<f64> = shares.into_iter().map(|(_, share)| share).collect();
        Some(MeanSd::of(&shares)?.mean)
    }

    /// Mean over the jobs that evaluate a person, of each person of a section, by the values of a job's score.
    fn means(
        &self,
        (data_set, group): Section<'_>,
        values: impl Fn(&'a Score) -> Vec<(&'a str, f64)>,
    ) -> Vec<(&'a str, f64)> {
        let mut by_person: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for score in self.of_group(group) {
            for (person, value) in values(score) {
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

    /// Quantiles of the latency over all gestures of a section's people, of all jobs.
    pub(crate) fn latency(&self, (data_set, group): Section<'_>) -> Option<LatencySummary> {
        let (mut latencies, mut gestures) = (Vec::new(), 0);
        for events in self
            .of_group(group)
            .flat_map(|score| &score.events.subjects)
        {
            if data_set.is_none_or(|set| is_of(&events.subject, set)) {
                latencies.extend_from_slice(&events.latencies);
                gestures += events.gestures;
            }
        }
        latency::summary(&latencies, gestures)
    }

    /// Quantiles of the release latency over all releases of a section's people, of all jobs, and the number of people with one.
    pub(crate) fn release(
        &self,
        (data_set, group): Section<'_>,
    ) -> (Option<LatencySummary>, usize) {
        let scores = self.of_group(group);
        let people = scores
            .flat_map(|score| &score.events.subjects)
            .filter(|own| data_set.is_none_or(|set| is_of(&own.subject, set)))
            .filter(|own| !own.releases.is_empty());
        let (mut releases, mut names) = (Vec::new(), BTreeSet::new());
        for own in people {
            releases.extend_from_slice(&own.releases);
            names.insert(&own.subject);
        }
        (latency::summary(&releases, releases.len()), names.len())
    }

    /// Movements outside the vocabulary, of all people and seeds, by the name of their kind.
    pub(crate) fn raised(&self) -> BTreeMap<&'a str, Tally> {
        self.by_kind(|person| &person.raised, Tally::plus)
    }

    /// Daily life, of all people and seeds, by the name of its kind.
    pub(crate) fn daily_life(&self) -> BTreeMap<&'a str, DailyUse> {
        self.by_kind(|person| &person.daily, DailyUse::plus)
    }

    /// Sums of what each person has of a kind, over all people and seeds.
    fn by_kind<T: Copy + Default + 'a>(
        &self,
        of: impl Fn(&'a SubjectEvents) -> &'a BTreeMap<String, T>,
        plus: impl Fn(T, T) -> T,
    ) -> BTreeMap<&'a str, T> {
        let mut by_kind: BTreeMap<&str, T> = BTreeMap::new();
        let people = self
            .scores
            .iter()
            .flat_map(|(_, score)| &score.events.subjects);
        for (kind, part) in people.flat_map(of) {
            let own = by_kind.entry(kind).or_default();
            *own = plus(*own, *part);
        }
        by_kind
    }

    /// Data sets of the people, in alphabetical order.
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
    use crate::cross_validation::fixture::{fold, origin};

    #[test]
    fn a_persons_value_is_the_mean_over_seeds_and_gestures_are_pooled() {
        let folds = [
            (
                origin(1, 1),
                fold("m", &[("x/a", 0.5, &[10], 2), ("y/b", 0.9, &[20, 40], 2)]),
            ),
            (origin(2, 1), fold("m", &[("x/a", 0.7, &[30, 30], 2)])),
            (origin(2, 2), fold("m", &[("y/b", 0.9, &[], 2)])),
        ];
        let scores = || {
            let folds = folds.iter();
            folds.flat_map(|(origin, scores)| scores.iter().map(|score| (*origin, score)))
        };
        let merged = Merged::new("p", LookAhead::AllRows, None, scores());
        assert_eq!(merged.name(), "p (0.25 s, all rows)");
        assert_eq!(merged.data_sets(), ["x", "y"]);
        let all = Group::AllClasses;
        let balanced = |set| merged.values(Measure::BalancedAccuracy, (set, all));
        assert_eq!(balanced(None), [("x/a", 0.6), ("y/b", 0.9)]);
        assert_eq!(balanced(Some("y")), [("y/b", 0.9)]);
        // The mean of the seeds' shares, not the share of all gestures.
        let recognised = merged.values(Measure::Recognition, (None, all));
        assert_eq!(recognised, [("x/a", 0.75), ("y/b", 0.5)]);
        // Labels 60 (person a, first seed), 80, 80 (second seed) samples after the onset; b's 70, 90 and none.
        let within = |ms| merged.recognised_within(ms, (None, all));
        assert_eq!(within(300), Some((0.25 + 0.0) / 2.0));
        assert_eq!(within(350), Some((0.25 + 0.25) / 2.0));
        assert_eq!(within(450), Some((0.75 + 0.5) / 2.0));
        // Offsets of 10, 30, 30 samples of four gestures, 50 samples later; one is missed.
        let expected = latency::summary(&[60, 80, 80], 4);
        assert_eq!(merged.latency((Some("x"), all)), expected);
        assert!(expected.is_some());
        // A release comes 40 samples after each offset.
        let expected = latency::summary(&[50, 70, 70], 3);
        assert_eq!(merged.release((Some("x"), all)), (expected, 1));
        assert_eq!(merged.release((None, Group::FewerClasses)), (None, 0));
        let gate = Some("entry=1".parse().unwrap());
        let none = Merged::new("p", LookAhead::AllRows, gate, scores());
        assert_eq!(none.name(), "p (0.25 s, all rows, entry=1)");
        assert!(
            none.values(Measure::BalancedAccuracy, (None, all))
                .is_empty()
        );
    }
}
