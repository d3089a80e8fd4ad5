//! Labels of a recording: the vocabulary they are taken from, when they change, how late they are, and
//! where the muscle is active in recordings that are published without labels.

pub(crate) mod activity;
pub mod compensation;
pub mod cued;
mod envelope;
pub mod lag;
pub mod motion;
pub(crate) mod runs;
pub mod set_lag;
pub(crate) mod timing;
pub mod vocabulary;
