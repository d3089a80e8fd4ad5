//! Cross-validation: the groups of subjects that the folds of a protocol hold out in turn.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use rand::seq::SliceRandom;

use crate::recording::{DataSet, Recording};
use crate::seed;

/// A cross-validation protocol: every subject is held out in one of its folds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Protocol {
    /// One subject of each data set per fold, in as many folds as the largest set has subjects.
    LeaveOneSubjectOut,
    /// A group of subjects per fold, in this number of folds: for models that cost too much to train once per subject.
    LeaveGroupsOut(usize),
}

impl Protocol {
    /// Number of folds that hold out every subject of the recordings once.
    #[must_use]
    pub fn folds<'a>(self, recordings: impl IntoIterator<Item = &'a Recording>) -> usize {
        match self {
            Self::LeaveOneSubjectOut => most_subjects(recordings),
            Self::LeaveGroupsOut(folds) => folds,
        }
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeaveOneSubjectOut => f.write_str("loso"),
            Self::LeaveGroupsOut(folds) => write!(f, "{folds}-fold"),
        }
    }
}

impl FromStr for Protocol {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "loso" {
            return Ok(Self::LeaveOneSubjectOut);
        }
        text.strip_suffix("-fold")
            .and_then(|folds| folds.parse().ok())
            .filter(|&folds| folds >= 2)
            .map(Self::LeaveGroupsOut)
            .ok_or_else(|| {
                format!("expected `loso`, or `4-fold` with any number from 2 on, found {text:?}")
            })
    }
}

/// The subjects that each of `folds` folds holds out, in alphabetical order.
///
/// Every subject is in exactly one group, and each group has its share of every data set's
/// subjects: with as many folds as the largest set has people, that is leave-one-subject-out, and
/// smaller sets hold out nobody in some folds. The seed assigns the subjects; a set's assignment
/// does not depend on the other sets.
#[must_use]
pub fn folds<'a>(
    recordings: impl IntoIterator<Item = &'a Recording>,
    folds: usize,
    seed: u64,
) -> Vec<Vec<String>> {
    let mut groups = vec![Vec::new(); folds];
    for (data_set, mut subjects) in subjects(recordings) {
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

fn most_subjects<'a>(recordings: impl IntoIterator<Item = &'a Recording>) -> usize {
    subjects(recordings)
        .values()
        .map(Vec::len)
        .max()
        .unwrap_or(0)
}

/// The subjects of each data set, in alphabetical order.
#[must_use]
pub fn subjects<'a>(
    recordings: impl IntoIterator<Item = &'a Recording>,
) -> BTreeMap<DataSet, Vec<&'a str>> {
    let mut subjects: BTreeMap<DataSet, Vec<&str>> = BTreeMap::new();
    for recording in recordings {
        subjects
            .entry(recording.data_set)
            .or_default()
            .push(&recording.subject);
    }
    for own in subjects.values_mut() {
        own.sort_unstable();
        own.dedup();
    }
    subjects
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use proptest::prelude::*;

    use super::*;

    fn recordings(roshambo: usize, ss_stm: usize) -> Vec<Recording> {
        let of = |data_set: DataSet, people| {
            (0..2 * people).map(move |at| Recording {
                data_set,
                subject: format!("{}/{}", data_set.name(), at / 2),
                name: at.to_string(),
                path: PathBuf::new(),
                samples: Vec::new(),
                labels: Vec::new(),
                notes: Vec::new(),
                other_movement: Vec::new(),
                timing: crate::Timing::Cues,
                findings: Vec::new(),
                wearer: shared::stream::normalizer::Normalizer::new(),
            })
        };
        of(DataSet::Roshambo, roshambo)
            .chain(of(DataSet::SsStm, ss_stm))
            .collect()
    }

    proptest! {
        #[test]
        fn everybody_is_held_out_once_and_sets_are_divided_evenly(
            people in (1..9_usize, 1..25_usize), count in 1..12_usize, seed: u64
        ) {
            let all = recordings(people.0, people.1);
            let groups = folds(&all, count, seed);
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
    fn as_many_folds_as_people_hold_one_out_each() {
        let all = recordings(3, 5);
        assert_eq!(most_subjects(&all), 5);
        let groups = folds(&all, most_subjects(&all), 42);
        let of = |set: &str| {
            let own = |group: &Vec<String>| group.iter().filter(|s| s.starts_with(set)).count();
            groups.iter().map(own).collect::<Vec<_>>()
        };
        assert_eq!(of("ss-stm/"), [1; 5]);
        assert_eq!(of("roshambo/"), [1, 1, 1, 0, 0]);
    }

    #[test]
    fn protocols_are_read_from_their_names() {
        let all = recordings(3, 5);
        assert_eq!("loso".parse::<Protocol>().unwrap().folds(&all), 5);
        assert_eq!("4-fold".parse::<Protocol>().unwrap().folds(&all), 4);
        for wrong in ["1-fold", "fold", "-fold", "LOSO", ""] {
            assert!(wrong.parse::<Protocol>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_seed_assigns_the_subjects() {
        let all = recordings(8, 20);
        assert_ne!(folds(&all, 4, 1), folds(&all, 4, 2));
        assert_eq!(folds(&all, 4, 1), folds(&all, 4, 1));
    }
}
