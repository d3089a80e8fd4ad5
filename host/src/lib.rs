//! From recordings to a model file: reading, training, distilling, quantizing, measuring.

pub mod average;
pub mod command;
pub mod corpus;
pub mod estimate;
pub mod evaluation;
pub mod fit;
pub mod interrupt;
pub mod loss;
pub mod metric;
pub mod parallel;
pub mod peers;
pub mod plan;
pub mod preset;
pub mod progress;
pub mod recording;
pub mod report;
pub mod run_folder;
pub mod schedule;
pub mod stage;
pub mod student;
pub mod study;
pub mod teacher;
