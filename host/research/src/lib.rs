//! Research beside the product: baselines and cross-validations.
//!
//! Models, metrics, data sets and run folders are those of the crate `myointent`, which does not depend
//! on this one.

#![deny(missing_docs)]

mod baselines;
pub mod cli;
mod cross_validation;
mod job;
mod personalization;
