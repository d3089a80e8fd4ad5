//! Training, development and test people: named once, in `host/recordings/people.toml`, for every preset.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use crate::catalogue::DataSet;

/// The people of one data set outside training, as the data set names them.
#[derive(Clone, PartialEq, Eq, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PredefinedSplit {
    /// Development people who choose the checkpoint and the aggregation mode.
    #[serde(default)]
    pub checkpoint: Vec<String>,
    /// Development people by whose scores settings are chosen.
    #[serde(default)]
    pub settings: Vec<String>,
    /// Test people, evaluated once a release.
    #[serde(default)]
    pub test: Vec<String>,
}

static COMMITTED: LazyLock<BTreeMap<String, PredefinedSplit>> = LazyLock::new(|| {
    toml::from_str(include_str!("../../people.toml")).expect("a test reads the file")
});

impl PredefinedSplit {
    /// Development and test people of a data set; none for sets that the file does not name.
    pub(crate) fn of(data_set: DataSet) -> Option<&'static Self> {
        COMMITTED.get(data_set.name())
    }

    /// Development and test people of all data sets, by the sets' names.
    pub fn all() -> &'static BTreeMap<String, Self> {
        &COMMITTED
    }
}

/// Whether a subject (`data-set/subject`) is a test person.
pub fn is_test(subject: &str) -> bool {
    let (set, _) = subject.split_once('/').unwrap_or_default();
    COMMITTED
        .get(set)
        .is_some_and(|predefined| is_listed(&predefined.test, subject))
}

/// Whether a subject (`data-set/subject`) is a training person: in none of the lists of a set that the file names.
pub fn is_training(subject: &str) -> bool {
    let (set, _) = subject.split_once('/').unwrap_or_default();
    COMMITTED.get(set).is_some_and(|predefined| {
        let lists = [
            &predefined.checkpoint,
            &predefined.settings,
            &predefined.test,
        ];
        !lists.iter().any(|list| is_listed(list, subject))
    })
}

/// Whether a list names a subject (`data-set/subject`).
pub(super) fn is_listed(list: &[String], subject: &str) -> bool {
    let person = subject
        .split_once('/')
        .map_or(subject, |(_, person)| person);
    list.iter().any(|name| name == person)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_is_listed_twice() {
        for (set, predefined) in PredefinedSplit::all() {
            let PredefinedSplit {
                checkpoint,
                settings,
                test,
            } = predefined;
            let mut people = [&checkpoint[..], settings, test].concat();
            let all = people.len();
            assert!(all > 0, "{set}");
            people.sort_unstable();
            people.dedup();
            assert_eq!(people.len(), all, "{set}");
        }
    }

    #[test]
    fn whoever_a_named_set_does_not_list_is_trained_on() {
        for (subject, is_in_training, is_in_test) in [
            ("roshambo/01", true, false),
            ("roshambo/03", false, false),
            ("roshambo/06", false, true),
            ("roshambo/08", false, false),
            ("own/anna", false, false),
            ("01", false, false),
            ("06", false, false),
        ] {
            let found = (is_training(subject), is_test(subject));
            assert_eq!(found, (is_in_training, is_in_test), "{subject}");
        }
    }
}
