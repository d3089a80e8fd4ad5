//! What a program needs to run on the emulated Cortex-M4F: start, heap, console, test harness.
//!
//! Named `test` by a crate under test, it takes the place of the standard harness (`harness`).
//! Console, command line, files and exit code are the emulator's, by semihosting.
#![no_std]
#![cfg(target_os = "none")]
#![deny(missing_docs)]
#![deny(unsafe_code)]

extern crate alloc;

pub mod files;
pub mod harness;
mod start;
pub mod timer;

// The paths that `#[test]` expands to have the crate `test` before them and nothing between.
pub use harness::*;
pub use semihosting::{print, println};
pub use start::{Arguments, arguments, start};
