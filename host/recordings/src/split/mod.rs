//! Split of people into roles. A person's recordings are never divided.
//!
//! Recordings of one person resemble each other far more than those of two people; a split by file
//! would measure recognition of a person.

mod assignment;
pub mod folds;
pub mod predefined;

pub use self::assignment::{Assignment, SplitError, assign, expand};
use super::recording::Recording;

/// Role of a subject.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Role {
    /// Subject whom weights are trained on.
    Training,
    /// Subject whose loss selects the checkpoint.
    Validation,
    /// Subject who is evaluated, never trained or validated on.
    HeldOut,
    /// Subject who is evaluated once a release, never trained or validated on.
    Test,
}

/// Subjects by role, each list in alphabetical order; no subject is in two.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Split {
    /// Subjects whom weights are trained on.
    pub training: Vec<String>,
    /// Subjects who select the checkpoint.
    pub validation: Vec<String>,
    /// Subjects who are evaluated.
    pub held_out: Vec<String>,
    /// Subjects who are evaluated once a release.
    #[serde(default)]
    pub test: Vec<String>,
}

impl Split {
    /// The role of a subject, if it has one.
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
    pub fn select<'a>(&self, recordings: &'a [Recording], role: Role) -> Vec<&'a Recording> {
        let is_own = |own: &&Recording| self.role(&own.subject) == Some(role);
        recordings.iter().filter(is_own).collect()
    }
}
