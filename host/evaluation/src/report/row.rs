//! A score under its name on a page.

use std::ops::Deref;

use crate::{ALL, Group, Score};

/// Row of a table or a picture: a score, and the name of its system there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row<'a> {
    /// Name of the system.
    pub name: String,
    /// The score.
    pub score: &'a Score,
}

impl<'a> Row<'a> {
    /// Row under the system's own name.
    pub(super) fn new(score: &'a Score) -> Self {
        let name = score.model.to_string();
        Self { name, score }
    }
}

impl Deref for Row<'_> {
    type Target = Score;

    fn deref(&self) -> &Score {
        self.score
    }
}

/// The rows over all recordings, or over the only data set: people with all classes first.
pub(super) fn over_all<'r, 'a>(rows: &'r [Row<'a>]) -> impl Iterator<Item = &'r Row<'a>> {
    let several = rows.iter().any(|row| row.data_set == ALL);
    let of = move |people| {
        let rows = rows.iter().filter(move |row| row.people == people);
        rows.filter(move |row| !several || row.data_set == ALL)
    };
    Group::ALL.into_iter().flat_map(of)
}

/// Sorts rows: people with all classes, then those with fewer; data set by data set.
pub(super) fn sort(rows: &mut [Row<'_>]) {
    rows.sort_by_key(|row| (row.score.people, &row.score.data_set));
}
