//! The student: its file format and the integer encoder that runs it.
//!
//! Imports go downwards only: `encoder` -> `head` -> `file` -> `dimensions`.

pub mod dimensions;
mod encode;
pub mod encoder;
pub mod file;
pub mod head;
#[cfg(any(test, feature = "write"))]
pub mod noise;

pub use crate::kernels::Aligned;
pub use encode::{Encode, LookBackLogits};
