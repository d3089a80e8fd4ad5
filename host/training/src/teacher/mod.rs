//! The teacher: the paper's masked multimodal transformer and its training (ReactEMG, arXiv 2506.19815).

mod attention;
pub mod batch;
pub mod checkpoint;
mod feed_forward;
pub mod learner;
pub mod model;
pub mod window;
