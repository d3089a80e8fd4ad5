//! People by the classes that their recordings have: no score is over those who have all and those who have fewer.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::metric::summary::SubjectScore;

/// The people of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// People whose recordings have all classes of the model.
    AllClasses,
    /// People whose recordings have fewer: their scores say nothing of the others.
    FewerClasses,
}

impl Group {
    /// Both, in the order of tables.
    pub const ALL: [Self; 2] = [Self::AllClasses, Self::FewerClasses];

    /// Name in tables, under a model of so many classes: `all 3`, `fewer`.
    #[must_use]
    pub fn name(self, of_model: usize) -> String {
        match self {
            Self::AllClasses => format!("all {of_model}"),
            Self::FewerClasses => "fewer".to_owned(),
        }
    }

    /// The same in words.
    #[must_use]
    pub(crate) fn told(self, of_model: usize) -> String {
        match self {
            Self::AllClasses => format!("with all {of_model} classes"),
            Self::FewerClasses => format!("with fewer than {of_model} classes"),
        }
    }
}

/// The group of each subject, under a model of so many classes.
pub(super) fn groups(subjects: &[SubjectScore], of_model: usize) -> BTreeMap<&str, Group> {
    let group = |own: &SubjectScore| {
        if own.classes >= of_model {
            Group::AllClasses
        } else {
            Group::FewerClasses
        }
    };
    let subjects = subjects.iter();
    subjects.map(|own| (&own.subject[..], group(own))).collect()
}
