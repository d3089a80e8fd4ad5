//! Comparison of presets, baselines and floors by cross-validation: each person but the test people is held out once a seed.
//!
//! A preset is trained on its own data sets without the people of the fold. Its integer student is evaluated on the fold's
//! people of all data sets, so that presets with different data sets are compared on the same people. Baselines are trained
//! on the recordings and people of the first preset. A person's value is the mean over seeds; intervals and differences are
//! over people. People whose recordings have all classes, people with fewer, and the test people have separate rows.

mod contender;
#[cfg(test)]
mod fixture;
mod job;
mod merged;
mod tables;
mod training;

pub(crate) use contender::{Contender, ContenderKind};
pub(crate) use job::{CrossValidation, FoldScore, Job, JobScores};
pub(crate) use merged::{Merged, Origin};
pub(crate) use tables::{
    daily_life, differences, emission, movements, over_sets, people, scores, test_scores,
};
