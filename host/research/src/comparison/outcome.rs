//! One way to train, over all of its folds.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::StudyError;
use super::check::check;
use super::merge::merge;
use myointent::evaluation::{ALL, LookAhead, Score, Truth};
use myointent::execution::run_folder::RunFolder;
use myointent::run::config::{CONFIG, Fold, ResolvedConfig};
use myointent::run::evaluate::{RESULTS, Results};

/// One judged run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its folder.
    pub path: PathBuf,
    /// What ran.
    pub config: ResolvedConfig,
    /// What came out.
    pub results: Results,
}

/// All folds of one way to train, checked and put together.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of its folder.
    pub name: String,
    /// The folds that are there, by number; one at least.
    pub runs: Vec<Run>,
    /// Scores over the people of all folds.
    pub results: Results,
}

impl Run {
    fn load(path: PathBuf) -> Result<Self, StudyError> {
        let folder = RunFolder::existing(&path)?;
        let config = ResolvedConfig::load(&folder)?;
        if !folder.file(RESULTS).exists() {
            return Err(StudyError::NotJudged { run: path });
        }
        let results = folder.load_json(RESULTS)?;
        Ok(Self {
            path,
            config,
            results,
        })
    }

    /// Which fold it is; a run by itself is the only one.
    #[must_use]
    pub fn fold(&self) -> Fold {
        self.config.fold.unwrap_or(Fold { number: 1, of: 1 })
    }

    /// Revision of the source that ran, if known.
    #[must_use]
    pub fn revision(&self) -> &str {
        self.config.git_revision.as_deref().unwrap_or("unknown")
    }
}

impl Outcome {
    /// Reads the folds in a variant's folder.
    ///
    /// # Errors
    /// When there is none, one is not judged, or they do not belong together.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let mut runs = sub_folders(path)?
            .into_iter()
            .filter(|folder| folder.join(CONFIG).exists())
            .map(Run::load)
            .collect::<Result<Vec<_>, _>>()?;
        if runs.is_empty() {
            return Err(StudyError::NoRuns {
                path: path.to_owned(),
                expected: "folders fold-K",
            });
        }
        runs.sort_by_key(|run| run.fold().number);
        check(&runs)?;
        // `.` and `..` have no name of their own.
        let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let name = full.file_name().unwrap_or(full.as_os_str());
        let results: Vec<&Results> = runs.iter().map(|run| &run.results).collect();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            results: merge(&results),
            runs,
        })
    }

    /// Folds of the protocol, those that are not there included.
    #[must_use]
    pub fn of(&self) -> usize {
        self.runs[0].fold().of
    }

    /// Numbers of the folds that are not there.
    #[must_use]
    pub fn missing(&self) -> Vec<usize> {
        let there: BTreeSet<usize> = self.runs.iter().map(|run| run.fold().number).collect();
        (1..=self.of())
            .filter(|number| !there.contains(number))
            .collect()
    }

    /// What tables show: no look-ahead, then 0.25 s in the reading of the results; runs that chose
    /// none are read as the paper does.
    #[must_use]
    pub fn look_aheads(&self) -> [LookAhead; 2] {
        let aggregation = match self.results.aggregation {
            LookAhead::None => LookAhead::AllRows,
            chosen => chosen,
        };
        [LookAhead::None, aggregation]
    }

    /// The line of a model over the recordings of a data set as published, if it was judged so.
    #[must_use]
    pub fn score(
        &self,
        model: &str,
        data_set: &str,
        look_ahead: LookAhead,
        truth: Truth,
    ) -> Option<&Score> {
        self.results.published.iter().find(|score| {
            score.model == model
                && score.data_set == data_set
                && score.look_ahead == look_ahead
                && score.truth == truth
        })
    }

    /// The data sets that were judged, in alphabetical order, all of them together last.
    #[must_use]
    pub fn data_sets(&self) -> BTreeSet<(bool, &str)> {
        let sets = self.results.published.iter().map(|v| v.data_set.as_str());
        sets.map(|set| (set == ALL, set)).collect()
    }

    /// The models that were judged, each once, in the order of the results.
    #[must_use]
    pub fn models(&self) -> Vec<&str> {
        let mut models = Vec::new();
        for score in &self.results.published {
            if !models.contains(&score.model.as_str()) {
                models.push(&score.model);
            }
        }
        models
    }
}

/// Folders in a folder, in the order of their names.
pub(super) fn sub_folders(path: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let failed = |source| StudyError::Folder {
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
