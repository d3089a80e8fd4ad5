//! Cross-validation: the groups of subjects that the folds of a protocol hold out in turn.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::str::FromStr;

use rand::seq::SliceRandom;

use crate::catalogue::DataSet;
use crate::recording::{Recording, by_data_set};
use crate::seed;

/// A cross-validation protocol: every subject is held out in one of its folds, except those of sets that
/// [only teach](DataSet::only_teaches).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Protocol {
    /// One subject of each data set per fold, in as many folds as the largest set has subjects.
    LeaveOneSubjectOut,
    /// A group of subjects per fold, in this number of folds: for models that cost too much to train once per subject.
    LeaveGroupsOut(usize),
    /// All subjects of one data set per fold: what a user meets who was recorded elsewhere. The sets that nothing is
    /// [trained on by default](DataSet::trained_by_default) share the last fold, whose model learns from all others. The people of
    /// [daily life](DataSet::is_daily_life) are divided among the folds: they belong to no set of gestures.
    LeaveSetsOut,
}

impl Protocol {
    /// The subjects that each fold holds out, in alphabetical order. The seed
    /// assigns the subjects of [`LeaveGroupsOut`](Self::LeaveGroupsOut) and
    /// [`LeaveOneSubjectOut`](Self::LeaveOneSubjectOut), those of a data set independently of the other sets.
    pub fn groups<'a>(
        self,
        recordings: impl IntoIterator<Item = &'a Recording>,
        seed: u64,
    ) -> Vec<Vec<String>> {
        let mut sets = subjects(recordings);
        sets.retain(|set, _| !set.only_teaches());
        let folds = match self {
            Self::LeaveOneSubjectOut => sets.values().map(Vec::len).max().unwrap_or(0),
            Self::LeaveGroupsOut(folds) => folds,
            Self::LeaveSetsOut => return of_sets(sets),
        };
        dealt(sets, folds, seed)
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeaveOneSubjectOut => f.write_str("loso"),
            Self::LeaveGroupsOut(folds) => write!(f, "{folds}-fold"),
            Self::LeaveSetsOut => f.write_str("sets"),
        }
    }
}

impl FromStr for Protocol {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let folds = text.strip_suffix("-fold");
        let folds = folds.and_then(|folds| folds.parse().ok());
        match text {
            "loso" => Some(Self::LeaveOneSubjectOut),
            "sets" => Some(Self::LeaveSetsOut),
            _ => folds.filter(|&folds| folds >= 2).map(Self::LeaveGroupsOut),
        }
        .ok_or_else(|| {
            format!(
                "expected `loso`, `sets`, or `4-fold` with any number from 2 on, found {text:?}"
            )
        })
    }
}

/// Subjects of each data set, in alphabetical order; those of the sets that nothing is trained on are one group. Behind them one of
/// each group, the people of daily life.
fn of_sets(sets: BTreeMap<DataSet, Vec<&str>>) -> Vec<Vec<String>> {
    let (mut groups, mut untrained, mut daily) =
        (Vec::<Vec<String>>::new(), Vec::new(), Vec::new());
    for (set, people) in sets {
        let people = people.into_iter().map(str::to_owned);
        if set.is_daily_life() {
            daily.extend(people);
        } else if set.trained_by_default() {
            groups.push(people.collect());
        } else {
            untrained.extend(people);
        }
    }
    untrained.sort_unstable();
    groups.extend((!untrained.is_empty()).then_some(untrained));
    let folds = groups.len().max(1);
    groups.resize(folds, Vec::new());
    for (at, person) in daily.into_iter().enumerate() {
        groups[at % folds].push(person);
    }
    groups
}

/// Subjects dealt to so many folds, in alphabetical order: each fold has its share of every data set's subjects. With as
/// many folds as the largest set has subjects, a fold has at most one of each set.
fn dealt(sets: BTreeMap<DataSet, Vec<&str>>, folds: usize, seed: u64) -> Vec<Vec<String>> {
    let mut groups = vec![Vec::new(); folds];
    for (data_set, mut subjects) in sets {
        subjects.shuffle(&mut seed::generator(seed, data_set.name()));
        for (at, subject) in subjects.into_iter().enumerate() {
            groups[at % folds].push(subject.to_owned());
        }
    }
    for group in &mut groups {
        group.sort_unstable();
    }
    groups
}

/// The subjects of each data set, in alphabetical order.
pub fn subjects<'a>(
    recordings: impl IntoIterator<Item = &'a Recording>,
) -> BTreeMap<DataSet, Vec<&'a str>> {
    let sets = by_data_set(recordings).into_iter();
    let subjects = sets.map(|(set, recordings)| {
        let subjects = recordings.into_iter().map(|own| own.subject.as_str());
        let subjects: BTreeSet<&str> = subjects.collect();
        (set, subjects.into_iter().collect())
    });
    subjects.collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::fixture::people;

    fn recordings(roshambo: usize, ss_stm: usize) -> Vec<Recording> {
        let sets = [("roshambo", roshambo), ("ss-stm", ss_stm)];
        sets.map(|(set, count)| people(DataSet::named(set), 0..count))
            .concat()
    }

    proptest! {
        #[test]
        fn everybody_is_held_out_once_and_sets_are_divided_evenly(
            people in (1..9_usize, 1..25_usize), count in 1..12_usize, seed: u64
        ) {
            let all = recordings(people.0, people.1);
            let groups = Protocol::LeaveGroupsOut(count).groups(&all, seed);
            prop_assert_eq!(groups.len(), count);
            let mut everybody: Vec<_> = groups.concat();
            everybody.sort_unstable();
            let mut expected: Vec<_> = all.iter().map(|r| r.subject.clone()).collect();
            expected.sort_unstable();
            expected.dedup();
            prop_assert_eq!(everybody, expected);
            for (set, people) in [("roshambo/", people.0), ("ss-stm/", people.1)] {
                for group in &groups {
                    let own = group.iter().filter(|s| s.starts_with(set)).count();
                    prop_assert!(own == people / count || own == people.div_ceil(count));
                }
            }
        }
    }

    #[test]
    fn protocols_are_read_from_their_names() {
        let all = recordings(3, 5);
        for (name, folds) in [("loso", 5), ("4-fold", 4), ("sets", 2)] {
            let protocol: Protocol = name.parse().unwrap();
            assert_eq!(protocol.to_string(), name);
            assert_eq!(protocol.groups(&all, 42).len(), folds, "{name}");
        }
        for wrong in ["1-fold", "fold", "-fold", "LOSO", "set", ""] {
            assert!(wrong.parse::<Protocol>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_seed_assigns_the_subjects() {
        let all = recordings(8, 20);
        let groups = |seed| Protocol::LeaveGroupsOut(4).groups(&all, seed);
        assert_ne!(groups(1), groups(2));
        assert_eq!(groups(1), groups(1));
    }

    #[test]
    fn a_fold_of_sets_holds_out_a_whole_set() {
        let mut all = recordings(1, 2);
        let unseen = ["uci-gestures", "ciil", "adl", "psl"].into_iter();
        all.extend(unseen.flat_map(|set| people(DataSet::named(set), 0..1)));
        let groups = Protocol::LeaveSetsOut.groups(&all, 42);
        let expected = [
            vec!["roshambo/0", "adl/0"],
            vec!["ss-stm/0", "ss-stm/1"],
            vec!["ciil/0", "uci-gestures/0"],
        ];
        assert_eq!(groups, expected);
    }
}
