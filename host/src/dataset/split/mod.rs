//! Split of subjects into training, validation and held out. Whole people, never files.
//!
//! Recordings of one person resemble each other far more than those of two people; a split by file
//! would measure recognition of a person.

mod choice;
mod error;
pub mod folds;

use std::collections::BTreeSet;

pub(crate) use self::choice::Choice;
use self::choice::choose;
pub use self::error::SplitError;
use super::recording::{DataSet, Recording};

/// What a subject is used for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Role {
    /// Weights are trained on it.
    Training,
    /// Its loss selects the checkpoint.
    Validation,
    /// Evaluated, never trained or validated on.
    HeldOut,
}

/// Whom to hold out and whom to validate on.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct SplitOptions {
    /// Seed of every draw.
    pub seed: u64,
    /// Chosen first, from all subjects.
    pub held_out: Choice,
    /// Chosen second, from those that remain.
    pub validation: Choice,
}

/// Subjects by role, each list in alphabetical order; no subject is in two.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Split {
    /// Trained on.
    pub training: Vec<String>,
    /// Select the checkpoint.
    pub validation: Vec<String>,
    /// Evaluated.
    pub held_out: Vec<String>,
}

impl Split {
    /// Chooses the subjects of the recordings.
    ///
    /// # Errors
    /// See [`SplitError`].
    pub(crate) fn new<'a>(
        recordings: impl IntoIterator<Item = &'a Recording>,
        options: &SplitOptions,
    ) -> Result<Self, SplitError> {
        let mut rest: BTreeSet<(DataSet, &str)> = recordings
            .into_iter()
            .map(|r| (r.data_set, r.subject.as_str()))
            .collect();
        let everybody = rest.clone();
        let held_out = choose(&options.held_out, &everybody, &rest, options.seed)?;
        rest.retain(|(_, subject)| !held_out.iter().any(|s| s == subject));
        let validation = choose(&options.validation, &everybody, &rest, options.seed)?;
        rest.retain(|(_, subject)| !validation.iter().any(|s| s == subject));
        if rest.is_empty() {
            return Err(SplitError::NothingToTrainOn);
        }
        let mut training: Vec<_> = rest.into_iter().map(|(_, s)| s.to_owned()).collect();
        training.sort_unstable();
        Ok(Self {
            training,
            validation,
            held_out,
        })
    }

    /// The role of a subject, if it has one.
    #[must_use]
    pub fn role(&self, subject: &str) -> Option<Role> {
        [
            (&self.training, Role::Training),
            (&self.validation, Role::Validation),
            (&self.held_out, Role::HeldOut),
        ]
        .into_iter()
        .find(|(subjects, _)| subjects.iter().any(|s| s == subject))
        .map(|(_, role)| role)
    }

    /// The recordings of one role, in their order.
    #[must_use]
    pub(crate) fn select<'a>(&self, recordings: &'a [Recording], role: Role) -> Vec<&'a Recording> {
        recordings
            .iter()
            .filter(|r| self.role(&r.subject) == Some(role))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::path::PathBuf;

    use super::*;

    fn recordings(sets: &[(DataSet, usize)]) -> Vec<Recording> {
        let mut all = Vec::new();
        for &(data_set, people) in sets {
            for person in 0..people {
                for name in ["a", "b"] {
                    all.push(Recording {
                        data_set,
                        subject: format!("{}/{person}", data_set.name()),
                        name: name.into(),
                        path: PathBuf::new(),
                        samples: Vec::new(),
                        labels: Vec::new(),
                        notes: Vec::new(),
                        other_movement: Vec::new(),
                    });
                }
            }
        }
        all
    }

    fn options(seed: u64, held_out: usize, validation: usize) -> SplitOptions {
        let per_set = |count| Choice::PerDataSet(BTreeMap::from([(DataSet::Roshambo, count)]));
        SplitOptions {
            seed,
            held_out: per_set(held_out),
            validation: per_set(validation),
        }
    }

    #[test]
    fn every_subject_has_one_role_with_all_its_recordings() {
        let all = recordings(&[(DataSet::Roshambo, 8), (DataSet::SsStm, 3)]);
        let split = Split::new(&all, &options(42, 2, 1)).unwrap();
        assert_eq!(
            (
                split.training.len(),
                split.validation.len(),
                split.held_out.len()
            ),
            (8, 1, 2)
        );
        let roles = [Role::Training, Role::Validation, Role::HeldOut];
        let counts = roles.map(|role| split.select(&all, role).len());
        assert_eq!(counts, [16, 2, 4]);
    }

    #[test]
    fn the_seed_decides_and_other_sets_do_not() {
        let alone = Split::new(&recordings(&[(DataSet::Roshambo, 8)]), &options(42, 2, 1)).unwrap();
        let more = recordings(&[(DataSet::Roshambo, 8), (DataSet::SsStm, 20)]);
        let together = Split::new(&more, &options(42, 2, 1)).unwrap();
        assert_eq!(alone.held_out, together.held_out);
        let draws: BTreeSet<_> = (0..20)
            .map(|seed| Split::new(&more, &options(seed, 2, 1)).unwrap().held_out)
            .collect();
        assert!(draws.len() > 5);
    }

    #[test]
    fn explicit_lists_are_taken_and_checked() {
        let all = recordings(&[(DataSet::Roshambo, 3)]);
        let list = |names: &[&str]| Choice::Subjects(names.iter().map(|&n| n.into()).collect());
        let mut wanted = SplitOptions {
            seed: 0,
            held_out: list(&["roshambo/2"]),
            validation: list(&["roshambo/0"]),
        };
        assert_eq!(Split::new(&all, &wanted).unwrap().training, ["roshambo/1"]);
        wanted.validation = list(&["roshambo/2"]);
        assert_eq!(
            Split::new(&all, &wanted),
            Err(SplitError::TwoRoles("roshambo/2".into()))
        );
        wanted.validation = list(&["roshambo/9"]);
        assert!(matches!(
            Split::new(&all, &wanted),
            Err(SplitError::UnknownSubject { .. })
        ));
        wanted.validation = list(&["roshambo/0", "roshambo/1"]);
        assert_eq!(Split::new(&all, &wanted), Err(SplitError::NothingToTrainOn));
    }

    #[test]
    fn more_than_there_are_is_refused() {
        let all = recordings(&[(DataSet::Roshambo, 3)]);
        let error = Split::new(&all, &options(1, 4, 0)).unwrap_err();
        assert_eq!(
            error,
            SplitError::TooFew {
                data_set: "roshambo",
                available: 3,
                wanted: 4
            }
        );
    }
}
