//! The paper's transformer, whole: masks, tasks, model, training (ReactEMG, arXiv 2506.19815).

pub mod attention;
pub mod checkpoint;
#[cfg(feature = "flex")]
mod exponential;
pub mod feed_forward;
pub mod masking;
pub mod model;
pub mod training;
pub mod window;
