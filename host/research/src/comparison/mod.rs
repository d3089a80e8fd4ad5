//! The paper's comparisons: what is trained and evaluated, and the tables of the results.
//!
//! Run folders are `STUDY/VARIANT/fold-K`, with `config.json` and `results.json` in each. A variant is one
//! way to train. Its folds hold out disjoint groups of subjects, so that every subject is held out once.
//! [`study`] fills the folders; [`results`] reads them and refuses folds that do not belong together;
//! [`tables`] uses nothing but these results.

pub(crate) mod results;
pub(crate) mod study;
pub(crate) mod tables;
pub(crate) mod variant;
