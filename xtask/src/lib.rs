//! The project's own build steps: which compiler builds for the board, and what comes out of it.
//!
//! A library as well as a command, because the tests that start an emulator build what it runs.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

pub mod clang;
pub mod count;
mod debian;
pub mod device;
pub mod emulator;
pub mod firmware;
pub mod qemu;
pub mod size;
pub mod stack;
pub mod toolchain;
pub mod vectors;
