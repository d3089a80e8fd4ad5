//! The program of the board: from the armband's radio to labels on pins and a UART.
//!
//! `shared` decides everything between notification and label. Here are the tasks that move data,
//! the Bluetooth stacks, and what differs between boards. Modules import downwards only:
//!
//! ```text
//! start           from reset to running tasks, from a panic to reset
//! tasks           radio, inference, output, control, watchdog
//! board           pins, UART, watchdog, Bluetooth controller: nRF52 or emulator
//! radio           the Myo session on a Bluetooth stack: SoftDevice or trouble
//! messages        what the tasks send each other
//! model_region    the model in flash
//! binding_region  the bound armband in flash
//! stack_guard     memory below the stack that nothing may access
//! settings, clock, reset_reason
//! ```
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![deny(missing_docs)]
#![deny(unsafe_code)]
#![deny(clippy::undocumented_unsafe_blocks)]

#[cfg(target_os = "none")]
mod binding_region;
#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod clock;
#[cfg(target_os = "none")]
mod messages;
#[cfg(target_os = "none")]
mod model_region;
#[cfg(target_os = "none")]
mod radio;
#[cfg(target_os = "none")]
mod reset_reason;
#[cfg(target_os = "none")]
mod settings;
#[cfg(target_os = "none")]
mod stack_guard;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod tasks;

/// On a PC there is no board to start; the crate still compiles, so that checks reach it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the board: build its image with `cargo xtask images`");
}
