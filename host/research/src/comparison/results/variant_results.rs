//! All folds of one variant, checked and merged.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::check::check;
use super::error::ResultsError;
use super::evaluated_run::EvaluatedRun;
use super::merge::merge;
use myointent::evaluation::{ALL, LookAhead, Score, Truth};
use myointent::run::config::CONFIG;
use myointent::run::evaluate::Results;

/// The results of one variant.
#[derive(Clone, Debug)]
pub(crate) struct VariantResults {
    /// Name of its folder.
    pub(crate) name: String,
    /// The evaluated folds, at least one, by number.
    pub(crate) runs: Vec<EvaluatedRun>,
    /// Scores over the subjects of all folds.
    pub(crate) merged: Results,
}

impl VariantResults {
    /// Reads the folds in a variant's folder.
    ///
    /// # Errors
    /// When there is none, one has not been evaluated, or they do not belong together.
    pub(crate) fn load(path: &Path) -> Result<Self, ResultsError> {
        let mut runs = sub_folders(path)?
            .into_iter()
            .filter(|folder| folder.join(CONFIG).exists())
            .map(EvaluatedRun::load)
            .collect::<Result<Vec<_>, _>>()?;
        if runs.is_empty() {
            return Err(ResultsError::NoRuns {
                path: path.to_owned(),
                expected: "folders fold-K",
            });
        }
        runs.sort_by_key(|run| run.fold().number);
        check(&runs)?;
        // The paths `.` and `..` have no file name.
        let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let name = full.file_name().unwrap_or(full.as_os_str());
        let results: Vec<&Results> = runs.iter().map(|run| &run.results).collect();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            merged: merge(&results),
            runs,
        })
    }

    /// Folds of the protocol, whether evaluated or missing.
    pub(crate) fn fold_count(&self) -> usize {
        self.runs[0].fold().of
    }

    /// Numbers of the folds that are missing.
    pub(crate) fn missing_folds(&self) -> Vec<usize> {
        let present: BTreeSet<usize> = self.runs.iter().map(|run| run.fold().number).collect();
        (1..=self.fold_count())
            .filter(|number| !present.contains(number))
            .collect()
    }

    /// The look-aheads that tables show: none, then 0.25 s with the aggregation mode of the merged
    /// results. Results without a mode get the paper's, all rows.
    pub(crate) fn look_aheads(&self) -> [LookAhead; 2] {
        let aggregation = match self.merged.aggregation {
            LookAhead::None => LookAhead::AllRows,
            chosen => chosen,
        };
        [LookAhead::None, aggregation]
    }

    /// A model's score on a data set as published; none if it was not evaluated so.
    pub(crate) fn score(
        &self,
        model: &str,
        data_set: &str,
        look_ahead: LookAhead,
        truth: Truth,
    ) -> Option<&Score> {
        self.merged.published.iter().find(|score| {
            score.model == model
                && score.data_set == data_set
                && score.look_ahead == look_ahead
                && score.truth == truth
        })
    }

    /// The evaluated data sets in alphabetical order, `(false, NAME)`, then all of them together,
    /// `(true, ALL)`.
    pub(crate) fn data_sets(&self) -> BTreeSet<(bool, &str)> {
        let sets = self.merged.published.iter().map(|s| s.data_set.as_str());
        sets.map(|set| (set == ALL, set)).collect()
    }

    /// The evaluated models, each once, in the order of the results.
    pub(crate) fn models(&self) -> Vec<&str> {
        let mut models = Vec::new();
        for score in &self.merged.published {
            if !models.contains(&score.model.as_str()) {
                models.push(&score.model);
            }
        }
        models
    }
}

/// Folders in a folder, by name.
pub(super) fn sub_folders(path: &Path) -> Result<Vec<PathBuf>, ResultsError> {
    let failed = |source| ResultsError::Folder {
        path: path.to_owned(),
        source,
    };
    let mut folders = Vec::new();
    for entry in std::fs::read_dir(path).map_err(failed)? {
        let entry = entry.map_err(failed)?.path();
        if entry.is_dir() {
            folders.push(entry);
        }
    }
    folders.sort_unstable();
    Ok(folders)
}
