//! The images that are flashed, on an emulated chip ([`nrf52`]): from reset to labels.
//!
//! Needs the cross compiler: `cargo xtask toolchain --install`.

#[path = "flashed/air.rs"]
mod air;
#[path = "flashed/alignment.rs"]
mod alignment;
#[path = "flashed/boot.rs"]
mod boot;
#[path = "flashed/calibration.rs"]
mod calibration;
#[path = "flashed/controller.rs"]
mod controller;
#[path = "flashed/dead_man.rs"]
mod dead_man;
#[path = "flashed/faults.rs"]
mod faults;
#[path = "flashed/flash.rs"]
mod flash;
#[path = "flashed/hid.rs"]
mod hid;
#[path = "flashed/installation.rs"]
mod installation;
#[path = "flashed/labels.rs"]
mod labels;
#[path = "flashed/merged.rs"]
mod merged;
#[path = "flashed/moments.rs"]
mod moments;
#[path = "flashed/pulses.rs"]
mod pulses;
#[path = "flashed/release.rs"]
mod release;
#[path = "flashed/start.rs"]
mod start;
#[path = "flashed/uart.rs"]
mod uart;
#[path = "flashed/uf2.rs"]
mod uf2;
#[path = "flashed/usb.rs"]
mod usb;
