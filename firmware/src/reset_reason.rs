//! Why the program started.

/// Why the core was reset.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum ResetReason {
    /// Power, the reset button or a debugger.
    Power,
    /// The watchdog: a task had stopped.
    Watchdog,
    /// The program itself, after a panic; on a chip also a debugger that asks for it.
    Software,
}

impl ResetReason {
    /// Its name on the UART.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Power => "power or reset",
            Self::Watchdog => "the watchdog",
            Self::Software => "software",
        }
    }
}
