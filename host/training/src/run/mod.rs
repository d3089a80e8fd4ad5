//! A run: its preset, its resolved configuration, and its steps, from recordings to an evaluated model file.

mod aggregation;
pub mod candidates;
pub mod context;
mod error;
pub mod evaluate;
pub mod personalize;
pub mod quantize;
mod soft_targets;
pub mod start;
mod student;
pub mod train;

pub use error::StepError;
