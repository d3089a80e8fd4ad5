//! The program of the board: from the armband's radio to labels on pins and a UART.
//!
//! `shared` decides everything between notification and label. Here are the tasks that move data,
//! the Bluetooth stacks, and what differs between boards. Modules import downwards only:
//!
//! ```text
//! start           from reset to running tasks
//! fault           from a panic to reset
//! tasks           radio, inference, output, control, watchdog
//! board           pins, UART, watchdog, Bluetooth controller: nRF52, or simulated on a PC
//! radio           the Myo session on a Bluetooth stack: SoftDevice or trouble
//! installation    the model is exchanged, or its calibration kept
//! messages        what the tasks send each other
//! model_region    the model in flash, with its calibration
//! binding_region  the bound armband in flash
//! hid_region      the outputs to a computer in flash
//! flash           both, and the journal of an installation, as they are written
//! stack_guard     memory below the stack that nothing may access
//! settings, clock, reset_reason
//! ```
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![deny(missing_docs)]
#![deny(unsafe_code)]
#![deny(clippy::undocumented_unsafe_blocks)]

mod binding_region;
mod board;
mod clock;
#[cfg(target_os = "none")]
mod fault;
mod flash;
#[cfg(feature = "uf2")]
mod hid_region;
mod installation;
mod messages;
mod model_region;
#[cfg(any(test, target_os = "none"))]
mod pulses;
mod radio;
mod reset_reason;
mod settings;
#[cfg(target_os = "none")]
mod stack_guard;
mod start;
mod tasks;

#[cfg(target_os = "none")]
#[embassy_executor::main]
async fn main(spawner: embassy_executor::Spawner) {
    stack_guard::start();
    start::start(spawner);
}

/// Simulates the board, the armband and the person on a PC.
#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    board::simulated::main(start::start)
}
