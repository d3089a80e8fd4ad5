//! Pins, clocks and wiring; no decisions.
//!
//! Every board gives the same names: `start`, which takes the peripherals with all outputs safe;
//! [`Pins`], [`LabelPort`] and [`Watchdog`], which drive them; `run_radio`, which brings up its
//! Bluetooth and follows the armband for ever; and `last_words`, for a panic.

#[cfg(feature = "emulator")]
mod emulator;
#[cfg(feature = "chip")]
mod nrf52;

#[cfg(feature = "emulator")]
pub use emulator::{LabelPort, Pins, RadioParts, Watchdog, last_words, run_radio, start};
#[cfg(feature = "chip")]
pub use nrf52::{LabelPort, Pins, RadioParts, Watchdog, last_words, run_radio, start};

use shared::stream::safe_state::{Cause, Status};

/// Why the program started.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Restart {
    /// Power, the reset button or a debugger.
    Power,
    /// The watchdog: a task had stopped.
    Watchdog,
    /// The program itself, after a panic; on a chip also a debugger that asks for it.
    Software,
}

impl Restart {
    /// As the UART tells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Power => "power or reset",
            Self::Watchdog => "the watchdog",
            Self::Software => "software",
        }
    }
}

/// A board as it starts.
pub struct Board {
    /// The line to whoever acts on labels.
    pub labels: LabelPort,
    /// What shows the label.
    pub pins: Pins,
    /// What the radio needs.
    pub radio: RadioParts,
    /// Runs already.
    pub watchdog: Watchdog,
    /// Why it started.
    pub restart: Restart,
}

/// What pins and LEDs show.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// Label and `valid`. Exactly one intent's pin is high, in the safe state that of relax.
    pub status: Status,
    /// Whether an armband streams.
    pub armband: bool,
}

impl Shown {
    /// What a start and a panic show.
    pub const SAFE: Self = Self {
        status: Status::Safe(Cause::Boot),
        armband: false,
    };
}
