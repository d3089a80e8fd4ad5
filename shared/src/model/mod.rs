//! The student: its file format, the integer encoder that runs it, and the kernels below.

pub mod arithmetic;
pub mod encoder;
pub mod file;
pub mod kernels;
