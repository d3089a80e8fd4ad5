//! Training: the paper's teacher, the student that learns from it, its quantization, and the steps of a run from recordings
//! to an evaluated model file.

#![deny(missing_docs)]

pub mod backend;
pub mod inference;
pub mod optimization;
pub mod run;
pub mod student;
pub mod teacher;
pub mod weights;
