//! An emulated nRF52840 and nRF52832: the images that are flashed run on it, byte for byte, in virtual time.
//!
//! ```text
//! Machine   time, and what the others ask of each other
//!   Core        rsemu's Cortex-M4F
//!   chip        peripherals, a file each, by the product specification
//!   softdevice  Nordic's supervisor calls and events
//!   controller  the functions of Nordic's controller library and MPSL
//!   air         the radio, with virtual armbands behind it
//! ```
//!
//! It is strict: what is not modelled, reserved, or belongs to the SoftDevice ends the run with its place
//! ([`Refusal`]). What it cannot show is in docs/emulated-chip.md.
#![forbid(unsafe_code)]

mod address_space;
pub mod air;
pub mod chip;
pub mod controller;
mod core;
mod image;
mod machine;
mod memory;
mod refusal;
pub mod softdevice;
pub mod time;

pub use crate::core::Core;
pub use image::{Image, ImageError};
pub use machine::{Incident, Machine};
pub use memory::{ERASED, Memory, RAM};
pub use refusal::{Refusal, What};
