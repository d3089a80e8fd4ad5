//! Presets, baselines and floors compared by cross-validation: every person but the test people is held out once for each seed.
//!
//! A preset is trained on its own data sets, without the people of the fold, and its integer student is evaluated on the
//! fold's people of all data sets, so that presets with different data sets are compared on the same people. Baselines
//! are trained on the recordings and people of the first preset. A person's value is the mean over seeds; intervals and
//! differences are over people. People whose recordings have all classes and people with fewer stand in rows of their own; so do
//! the test people, if they are asked for.
//!
//! The paper's tables ([`paper`]) are made of the same jobs: one preset's student beside teachers and all baselines.

mod contender;
#[cfg(test)]
mod fixture;
mod gate;
mod job;
mod job_scores;
mod merged;
mod paper;
mod tables;
mod teacher;
mod training;

pub(crate) use contender::{Contender, Kind};
pub(crate) use gate::Gate;
pub(crate) use job::{CrossValidation, Job};
pub(crate) use job_scores::{FoldScore, JobScores};
pub(crate) use merged::{Merged, Origin};
pub(crate) use paper::paper_tables;
pub(crate) use tables::{differences, movements, people, scores, test_scores};
pub(crate) use teacher::PaperTeacher;
