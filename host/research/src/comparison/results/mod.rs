//! The results of a study, read from its run folders.

mod check;
mod error;
mod evaluated_run;
#[cfg(test)]
pub(crate) mod fixture;
mod merge;
mod provenance;
mod study_results;
mod variant_results;

pub(crate) use study_results::StudyResults;
pub(crate) use variant_results::VariantResults;
