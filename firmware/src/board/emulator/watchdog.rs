//! The CMSDK watchdog: counts down, interrupts at zero, resets at zero for the second time.

use super::{registers::Register, straps};

const LOAD: Register = Register::at(0x4000_8000);
const CONTROL: Register = Register::at(0x4000_8008);
const CLEAR: Register = Register::at(0x4000_800c);
const INTERRUPT_AND_RESET: u32 = 0b11;
const COUNTS_PER_MS: u64 = 25_000;

/// A running watchdog.
pub struct Watchdog {
    counts: u32,
}

impl Watchdog {
    /// Starts it; it cannot be stopped.
    pub fn start(period_ms: u32) -> Self {
        // Half the period, for the reset comes at the second zero.
        let counts = u64::from(period_ms) * COUNTS_PER_MS * straps::time_scale() / 2;
        let counts = u32::try_from(counts).unwrap_or(u32::MAX);
        LOAD.write(counts);
        CONTROL.write(INTERRUPT_AND_RESET);
        Self { counts }
    }

    /// Restarts the period.
    pub fn feed(&mut self) {
        // A first zero stays in force until it is cleared, and the next one would be the reset.
        CLEAR.write(1);
        LOAD.write(self.counts);
    }
}
