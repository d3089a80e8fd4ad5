//! Split of subjects into roles. Whole people, never files.
//!
//! Recordings of one person resemble each other far more than those of two people; a split by file
//! would measure recognition of a person.

mod assignment;
pub mod circles;
mod error;
pub mod folds;

pub use self::assignment::{Assignment, assign, expand};
pub use self::error::SplitError;
use super::recording::Recording;

/// What a subject is used for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Role {
    /// Weights are trained on it.
    Training,
    /// Its loss selects the checkpoint.
    Validation,
    /// Evaluated, never trained or validated on.
    HeldOut,
    /// Evaluated once a release, never trained or validated on.
    Test,
}

/// Subjects by role, each list in alphabetical order; no subject is in two.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Split {
    /// Trained on.
    pub training: Vec<String>,
    /// Select the checkpoint.
    pub validation: Vec<String>,
    /// Evaluated.
    pub held_out: Vec<String>,
    /// Evaluated once a release.
    #[serde(default)]
    pub test: Vec<String>,
}

impl Split {
    /// The role of a subject, if it has one.
    #[must_use]
    pub fn role(&self, subject: &str) -> Option<Role> {
        [
            (&self.training, Role::Training),
            (&self.validation, Role::Validation),
            (&self.held_out, Role::HeldOut),
            (&self.test, Role::Test),
        ]
        .into_iter()
        .find(|(subjects, _)| subjects.iter().any(|s| s == subject))
        .map(|(_, role)| role)
    }

    /// The recordings of one role, in their order.
    #[must_use]
    pub fn select<'a>(&self, recordings: &'a [Recording], role: Role) -> Vec<&'a Recording> {
        recordings
            .iter()
            .filter(|r| self.role(&r.subject) == Some(role))
            .collect()
    }
}
