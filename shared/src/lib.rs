//! Everything between an armband's notification and a steady label.
//!
//! No heap, no clock, no hardware: the same code runs in the tests, in `myointent replay`, in the
//! emulated Cortex-M4F and on the board.
#![no_std]
#![deny(missing_docs)]
#![cfg_attr(not(cortex_m4), forbid(unsafe_code))]
#![deny(unsafe_code)]
// The unit tests have no std either: they also run on a core without operating system, under the
// harness of tests/device/runtime.
#![cfg_attr(
    all(test, target_os = "none"),
    no_main,
    feature(custom_test_frameworks),
    reexport_test_harness_main = "run_tests"
)]

#[cfg(any(test, feature = "write"))]
extern crate alloc;

#[cfg(all(test, target_os = "none"))]
test::entry!(run_tests);

pub mod intent;
pub mod model;
pub mod myo;
pub mod pipeline;
pub mod stream;
pub mod uart_line;
pub mod units;
