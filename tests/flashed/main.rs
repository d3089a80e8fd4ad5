//! The images that are flashed, on an emulated chip ([`nrf52`]): from reset to labels.
//!
//! Needs the cross compiler: `cargo xtask toolchain --install`.

mod air;
mod boot;
mod calibration;
mod controller;
mod dead_man;
mod faults;
mod flash;
mod hid;
mod installation;
mod labels;
mod merged;
mod moments;
mod pulses;
mod release;
mod start;
mod uart;
mod uf2;
mod usb;
