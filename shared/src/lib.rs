//! From an armband's notification to a stable intent label.
//!
//! No heap, no clock, no hardware: the same code runs in the tests, in `myointent replay`, in the
//! emulated Cortex-M4F and on the board.
//!
//! | module | content |
//! | --- | --- |
//! | [`pipeline`] | the composition of everything below, sample by sample: start reading here |
//! | [`calibration`] | a model's last layer, learnt from its wearer |
//! | [`uart_line`] | format of the UART line |
//! | [`hid`] | labels as keys, buttons and axes of a USB keyboard, mouse or gamepad |
//! | [`myo`] | the session with a Myo armband, without I/O |
//! | [`model`] | the student: file format, integer encoder |
//! | [`stream`] | link sequence numbers, preprocessing, sample ring, smoother, safe state |
//! | `kernels`, `arithmetic` | inner loops in plain Rust and with the vector instructions of a Cortex-M4 and an x86-64; float functions |
//! | `uf2` | files for the drive of a boot loader; with the feature `write` |
//! | [`installation`] | a new model in place of the one in flash, block by block |
//! | `checksum` | CRC-32 of a few bytes |
//! | [`button`] | a push button: pressed, held |
//! | [`intent`], [`units`] | intents and classes; samples, patches, time |
//! | `names` | enums whose variants have names on the UART line |
//!
//! Imports go downwards in this table.
#![no_std]
#![deny(missing_docs)]
#![cfg_attr(not(any(cortex_m4, target_arch = "x86_64")), forbid(unsafe_code))]
#![deny(unsafe_code)]
// The unit tests have no std either: they also run on the emulated core, under the harness of
// tests/device/runtime.
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

mod arithmetic;
pub mod button;
pub mod calibration;
mod checksum;
pub mod hid;
pub mod installation;
pub mod intent;
mod kernels;
pub mod model;
pub mod myo;
mod names;
pub mod pipeline;
pub mod stream;
pub mod uart_line;
#[cfg(any(test, feature = "write"))]
pub mod uf2;
pub mod units;
