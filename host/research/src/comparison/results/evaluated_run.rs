//! One evaluated run: one fold of a variant.

use std::path::PathBuf;

use super::error::ResultsError;
use myointent::execution::run_folder::RunFolder;
use myointent::run::config::{Fold, ResolvedConfig};
use myointent::run::evaluate::{RESULTS, Results};

/// One evaluated run.
#[derive(Clone, Debug)]
pub(crate) struct EvaluatedRun {
    /// Its folder.
    pub(crate) path: PathBuf,
    /// Its resolved configuration.
    pub(crate) config: ResolvedConfig,
    /// Its scores.
    pub(crate) results: Results,
}

impl EvaluatedRun {
    /// Reads a run folder.
    ///
    /// # Errors
    /// When the run has not been evaluated, or a file is damaged.
    pub(super) fn load(path: PathBuf) -> Result<Self, ResultsError> {
        let folder = RunFolder::existing(&path)?;
        let config = ResolvedConfig::load(&folder)?;
        if !folder.file(RESULTS).exists() {
            return Err(ResultsError::NotEvaluated { run: path });
        }
        let results = folder.load_json(RESULTS)?;
        Ok(Self {
            path,
            config,
            results,
        })
    }

    /// Which fold it is; a run without a protocol is fold 1 of 1.
    pub(crate) fn fold(&self) -> Fold {
        self.config.fold.unwrap_or(Fold { number: 1, of: 1 })
    }

    /// Source revision of the run, if known.
    pub(crate) fn revision(&self) -> &str {
        self.config.git_revision.as_deref().unwrap_or("unknown")
    }
}
