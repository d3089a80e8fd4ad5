//! Choice of the subjects of one role.

use std::collections::{BTreeMap, BTreeSet};

use rand::seq::SliceRandom;

use super::error::SplitError;
use crate::dataset::recording::DataSet;
use crate::dataset::seed;

/// How to choose subjects.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Choice {
    /// These, as [`Recording::subject`] names them.
    Subjects(Vec<String>),
    /// A number of each data set, drawn by the seed. A set's draw does not depend on the others.
    PerDataSet(BTreeMap<DataSet, usize>),
}

/// The subjects chosen from `rest`, in alphabetical order.
pub(super) fn choose(
    choice: &Choice,
    everybody: &BTreeSet<(DataSet, &str)>,
    rest: &BTreeSet<(DataSet, &str)>,
    seed: u64,
) -> Result<Vec<String>, SplitError> {
    let mut chosen = Vec::new();
    match choice {
        Choice::Subjects(subjects) => {
            for subject in subjects {
                if !everybody.iter().any(|(_, s)| s == subject) {
                    return Err(unknown(subject, everybody));
                }
                if !rest.iter().any(|(_, s)| s == subject) {
                    return Err(SplitError::TwoRoles(subject.clone()));
                }
                chosen.push(subject.clone());
            }
        }
        Choice::PerDataSet(counts) => {
            for (&data_set, &wanted) in counts {
                let mut subjects: Vec<_> = rest
                    .iter()
                    .filter(|(set, _)| *set == data_set)
                    .map(|(_, s)| *s)
                    .collect();
                if subjects.len() < wanted {
                    let (data_set, available) = (data_set.name(), subjects.len());
                    return Err(SplitError::TooFew {
                        data_set,
                        available,
                        wanted,
                    });
                }
                subjects.shuffle(&mut seed::generator(seed, data_set.name()));
                chosen.extend(subjects[..wanted].iter().map(|&s| s.to_owned()));
            }
        }
    }
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

fn unknown(subject: &str, everybody: &BTreeSet<(DataSet, &str)>) -> SplitError {
    let set = subject.split('/').next().unwrap_or_default();
    let mut near: Vec<_> = everybody
        .iter()
        .map(|(_, s)| *s)
        .filter(|s| s.starts_with(set))
        .collect();
    near.truncate(8);
    let known = if near.is_empty() {
        format!("{} subjects, none of {set:?}", everybody.len())
    } else {
        format!("{} ...", near.join(", "))
    };
    SplitError::UnknownSubject {
        subject: subject.to_owned(),
        known,
    }
}
