//! From recordings to a model file: reading, training, distilling, quantizing, measuring.

#![deny(missing_docs)]

pub mod board;
pub mod cli;
pub mod inference;
pub mod live;
pub mod record;
pub mod run;
pub mod student;
pub mod teacher;
pub mod training;
pub mod weights;
