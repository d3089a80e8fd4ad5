//! One evaluated run: one fold of a variant.

use std::collections::BTreeSet;
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
    /// Source revision of the program that evaluated it, if known.
    evaluated_by: Option<String>,
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
        let results = folder.load_stamped(RESULTS, config.fingerprint())?;
        Ok(Self {
            path,
            config,
            results: results.content,
            evaluated_by: results.revision,
        })
    }

    /// Which fold it is; a run without a protocol is fold 1 of 1.
    pub(crate) fn fold(&self) -> Fold {
        self.config.fold.unwrap_or(Fold { number: 1, of: 1 })
    }

    /// Source revisions of the programs that began the run and that evaluated it, each once.
    pub(crate) fn revisions(&self) -> BTreeSet<&str> {
        let began = self.config.git_revision.as_deref();
        let evaluated = self.evaluated_by.as_deref();
        [began, evaluated]
            .map(|revision| revision.unwrap_or("unknown"))
            .into()
    }
}
