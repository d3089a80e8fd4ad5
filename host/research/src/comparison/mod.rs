//! The paper's comparisons on the recordings at hand: the jobs, and the tables of what came out.
//!
//! On disk `STUDY/VARIANT/fold-K/{config.json,results.json}`. A variant is one way to train; its
//! folds leave disjoint groups of people out, so that everybody is left out once. [`job`] fills the
//! folders; all else here reads them: every number of a table comes from run folders alone, and what
//! does not belong together is refused ([`StudyError`]) rather than averaged.

mod ablation;
mod check;
mod difference;
mod error;
#[cfg(test)]
mod fixture;
mod folds;
pub mod job;
mod merge;
mod offsets;
mod outcome;
mod provenance;
mod scores;
mod section;
mod sheet;
mod tables;
pub mod variant;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub use error::StudyError;
pub use folds::folds;
pub use merge::merge;
pub use outcome::{Outcome, Run};
pub use section::Section;
pub use sheet::{Column, Row, Sheet};
pub use tables::{Tables, tables};

/// What all runs below a folder came to.
#[derive(Clone, Debug)]
pub struct Outcomes {
    /// The folder.
    pub path: PathBuf,
    /// By the variant's name, which is that of the sub-folder.
    pub variants: BTreeMap<String, Outcome>,
}

/// Reads all variants below a folder; sub-folders without runs are passed over.
///
/// # Errors
/// When there is no run at all, or a variant's folds do not belong together.
pub fn load(path: &Path) -> Result<Outcomes, StudyError> {
    let mut variants = BTreeMap::new();
    for folder in outcome::sub_folders(path)? {
        match Outcome::load(&folder) {
            Ok(variant) => {
                variants.insert(variant.name.clone(), variant);
            }
            Err(StudyError::NoRuns { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    if variants.is_empty() {
        return Err(StudyError::NoRuns {
            path: path.to_owned(),
            expected: "folders VARIANT/fold-K",
        });
    }
    Ok(Outcomes {
        path: path.to_owned(),
        variants,
    })
}
