//! A run: its preset, its resolved configuration, and its steps, from recordings to an evaluated model file.

mod aggregation;
pub mod candidates;
pub mod config;
pub mod context;
pub mod distill;
mod error;
pub mod evaluate;
mod lag;
pub(crate) mod lineage;
pub mod model_evaluation;
pub mod personalize;
mod preflight;
pub mod quantize;
pub mod resolve;
mod soft_targets;
mod streams;
pub mod template;
pub mod train;
mod trials;

pub use error::StepError;
