//! The program of the board: from the armband's radio to labels on pins and a UART.
//!
//! `shared` decides everything between notification and label; here are the tasks that move data,
//! the radios, and what differs between boards.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![deny(missing_docs)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod model_region;
#[cfg(target_os = "none")]
mod queue;
#[cfg(target_os = "none")]
mod radio;
#[cfg(target_os = "none")]
mod settings;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod tasks;

/// On a PC there is no board to start; the crate still compiles, so that checks reach it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the board: build its image with `cargo xtask images`");
}
