//! The runtime of programs on the emulated Cortex-M4F: start, heap, console, test harness.
//!
//! A crate under test that depends on it under the name `test` gets its harness instead of the
//! standard one. Console, command line, files and exit code go to the emulator by semihosting.
#![no_std]
#![cfg(target_os = "none")]
#![deny(missing_docs)]
#![deny(unsafe_code)]
#![deny(clippy::undocumented_unsafe_blocks)]

extern crate alloc;

pub mod files;
pub mod harness;
mod start;
pub mod timer;

pub use files::{Arguments, arguments};
// `#[test]` expands to paths directly under the crate `test`.
pub use harness::*;
pub use semihosting::{print, println};
pub use start::start;
