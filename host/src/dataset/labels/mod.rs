//! Labels of a recording: the vocabulary they are taken from, when they change, how late they are.

pub mod lag;
pub(crate) mod runs;
pub(crate) mod vocabulary;
