//! From recordings to a model file: reading, training, distilling, quantizing, measuring.

#![deny(missing_docs)]

pub mod board;
pub mod cli;
pub mod live;
pub mod record;
