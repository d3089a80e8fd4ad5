//! All variants of a study.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::ResultsError;
use myointent::execution::revision::is_dirty;

use super::variant_results::{VariantResults, sub_folders};

/// The results of all variants of a study.
#[derive(Clone, Debug)]
pub(crate) struct StudyResults {
    /// The study's folder.
    pub(crate) path: PathBuf,
    /// By the variant's name, which is that of its folder.
    pub(crate) variants: BTreeMap<String, VariantResults>,
}

impl StudyResults {
    /// Reads the folders of all variants; folders without runs are ignored.
    ///
    /// # Errors
    /// When there is no run at all, or the folds of a variant do not belong together.
    pub(crate) fn load(path: &Path) -> Result<Self, ResultsError> {
        let mut variants = BTreeMap::new();
        for folder in sub_folders(path)? {
            match VariantResults::load(&folder) {
                Ok(variant) => {
                    variants.insert(variant.name.clone(), variant);
                }
                Err(ResultsError::NoRuns { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        if variants.is_empty() {
            return Err(ResultsError::NoRuns {
                path: path.to_owned(),
                expected: "folders VARIANT/fold-K",
            });
        }
        Ok(Self {
            path: path.to_owned(),
            variants,
        })
    }

    /// Refuses runs of a program whose source had changes that were not committed.
    ///
    /// # Errors
    /// [`ResultsError::Dirty`] for the first.
    pub(crate) fn refuse_dirty(&self) -> Result<(), ResultsError> {
        let runs = self.variants.values().flat_map(|variant| &variant.runs);
        let mut dirty = runs.flat_map(|run| {
            let revisions = run.revisions().into_iter();
            revisions
                .filter(|revision| is_dirty(revision))
                .map(move |revision| (run, revision))
        });
        match dirty.next() {
            None => Ok(()),
            Some((run, revision)) => Err(ResultsError::Dirty {
                run: run.path.clone(),
                revision: revision.to_owned(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::comparison::results::fixture::Fixture;

    #[test]
    fn a_run_of_a_source_with_changes_is_refused() {
        let fixture = Fixture::new();
        let first = fixture.fold("main", 1, 2).held_out("roshambo/01");
        first.write();
        assert!(fixture.study().refuse_dirty().is_ok());
        let second = fixture.fold("main", 2, 2).held_out("roshambo/02");
        let dirty = Some("abc-dirty".to_owned());
        second
            .config(move |config| config.git_revision = dirty)
            .write();
        let refused = fixture.study().refuse_dirty().unwrap_err().to_string();
        assert!(
            refused.contains("fold-2 was made by revision abc-dirty"),
            "{refused}"
        );
    }
}
