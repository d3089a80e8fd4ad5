//! From recordings to a model file: reading, training, distilling, quantizing, measuring.

pub mod metric;
pub mod recording;
