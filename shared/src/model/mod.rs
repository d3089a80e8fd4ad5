//! The student: its file format, the integer encoder that runs it, and the kernels.
//!
//! Imports go downwards only: `encoder` -> `file` -> `dimensions` -> `kernels` -> `arithmetic`.

mod arithmetic;
pub mod dimensions;
mod encode;
pub mod encoder;
pub mod file;
mod kernels;
#[cfg(any(test, feature = "write"))]
pub mod noise;

pub use encode::{Encode, LookBackLogits};
pub use kernels::Aligned;
