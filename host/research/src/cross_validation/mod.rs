//! Presets, baselines and floors compared by cross-validation: every person but the test people is held out once for each seed.
//!
//! A preset is trained on its own data sets, without the people of the fold, and its integer student is evaluated on the
//! fold's people of all data sets, so that presets with different data sets are compared on the same people. Baselines
//! are trained on the recordings and people of the first preset. A person's value is the mean over seeds; intervals and
//! differences are over people.

mod contender;
mod job;
mod merged;
mod tables;

pub(crate) use contender::{Contender, Kind};
pub(crate) use job::{CrossValidation, FoldScore, Job};
pub(crate) use merged::Merged;
pub(crate) use tables::{differences, movements, people, scores};
