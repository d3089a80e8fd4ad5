//! Groups of people by the classes in their recordings. No score mixes people with all classes and people with fewer.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::metric::summary::SubjectScore;

/// Group of the people of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// People whose recordings have all classes of the model.
    AllClasses,
    /// People whose recordings have fewer classes: their scores cannot be compared with the others' scores.
    FewerClasses,
}

impl Group {
    /// Both groups, in the order of tables.
    pub const ALL: [Self; 2] = [Self::AllClasses, Self::FewerClasses];

    /// Name in tables, under a model of `of_model` classes: `all 3`, `fewer`.
    pub fn name(self, of_model: usize) -> String {
        match self {
            Self::AllClasses => format!("all {of_model}"),
            Self::FewerClasses => "fewer".to_owned(),
        }
    }

    /// Name in words, under a model of `of_model` classes.
    pub(crate) fn told(self, of_model: usize) -> String {
        match self {
            Self::AllClasses => format!("with all {of_model} classes"),
            Self::FewerClasses => format!("with fewer than {of_model} classes"),
        }
    }
}

/// Group of each subject, under a model of `of_model` classes.
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
