//! Research beside the product: the paper's five baselines, its comparisons and their tables, and the
//! aggregation of overlapping windows that its published numbers were computed with.
//!
//! Models, metrics, data sets and run folders are those of the crate `myointent`, which does not depend
//! on this one.

#![deny(missing_docs)]

mod baselines;
pub mod cli;
mod comparison;
mod cross_validation;
mod job;
pub mod offline;
mod personalization;
