//! Virtual Myo armband for tests, without a clock and without a radio: its driver passes the time.
//!
//! The simulated board (`firmware/src/board/simulated`) and the emulated chip (`tests/nrf52`) put their radios in front
//! of it.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod armband;
mod behaviour;
pub mod gatt;

pub use armband::{Armband, Notification};
pub use behaviour::{ArmbandFault, Behaviour, Corruption, End};
