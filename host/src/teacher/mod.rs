//! The teacher: the paper's masked multimodal transformer and its training (ReactEMG, arXiv 2506.19815).

mod attention;
pub mod batch;
pub mod checkpoint;
pub(crate) mod config;
mod feed_forward;
pub mod learner;
pub(crate) mod lora;
pub mod masking;
pub mod model;
pub mod training;
pub mod window;
