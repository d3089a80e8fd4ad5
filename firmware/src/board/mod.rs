//! The hardware: pins, clocks, UART, watchdog, Bluetooth controller. No decisions.
//!
//! Every board has the same items: `start`, which takes the peripherals and sets all outputs to
//! their safe levels; [`Pins`], [`LabelPort`], [`Watchdog`] and [`DeadMan`], which drive them; [`Button`] and [`CommandPort`], which
//! are inputs; `run_radio`, which starts its Bluetooth stack and runs the Myo session on it; and `enter_safe_state`, for a panic. On a PC the board is simulated.

#[cfg(target_os = "none")]
mod nrf52;
#[cfg(not(target_os = "none"))]
pub mod simulated;

#[cfg(all(feature = "uf2", target_os = "none"))]
pub use nrf52::Battery;
#[cfg(target_os = "none")]
pub use nrf52::{
    Button, CommandPort, DeadMan, LabelPort, Pins, RadioParts, Watchdog, enter_safe_state,
    run_radio, start,
};
#[cfg(not(target_os = "none"))]
pub use simulated::{
    Button, CommandPort, DeadMan, LabelPort, Pins, RadioParts, Watchdog, run_radio, start,
};

use crate::reset_reason::ResetReason;

/// Received bytes were lost: not taken in time, or by an error on the line.
pub struct BytesLost;

/// Lines that commands come by: the UART, and USB where the board has it.
pub const LINES: usize = if cfg!(feature = "uf2") { 2 } else { 1 };

pub struct Board {
    /// The UART that labels are written to, and USB.
    pub labels: LabelPort,
    /// The lines that commands come from: the same.
    pub commands: CommandPort,
    pub pins: Pins,
    /// Pressed and held by a person.
    pub button: Button,
    pub radio: RadioParts,
    /// Runs already.
    pub watchdog: Watchdog,
    /// Makes the pins safe without the program, from its first clearing on.
    pub dead_man: DeadMan,
    /// Measures the board's own battery.
    #[cfg(feature = "uf2")]
    pub battery: Battery,
    pub reset_reason: ResetReason,
}
