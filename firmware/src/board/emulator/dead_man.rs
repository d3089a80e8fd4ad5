//! The dead-man timer: the dual timer's first half, whose interrupt has the highest priority.
//!
//! The nearest thing to the hardware of a chip, which needs no instruction: here a handler writes the levels.
//! It interrupts tasks, other handlers and endless loops, but no code that has disabled interrupts.

use core::sync::atomic::{AtomicBool, Ordering};

use super::{Pins, irq::Irq, registers::Register, straps};
use crate::messages::pin_state::{self, PinState};

const LOAD: Register = Register::at(0x4000_2000);
const CONTROL: Register = Register::at(0x4000_2008);
const CLEAR_INTERRUPT: Register = Register::at(0x4000_200c);
/// Enabled, from the value of `LOAD`, with interrupt, 32 bits, once.
const ONE_SHOT: u32 = 1 << 7 | 1 << 6 | 1 << 5 | 1 << 1 | 1;
const COUNTS_PER_MS: u64 = 25_000;

static EXPIRED: AtomicBool = AtomicBool::new(false);

/// A timer that makes the pins safe unless it is cleared in time.
pub struct DeadMan {
    counts: u32,
}

impl DeadMan {
    /// Prepares it; it runs from the first [`DeadMan::clear`] on.
    pub fn start(period_ms: u32) -> Self {
        let counts = u64::from(period_ms) * COUNTS_PER_MS * straps::time_scale();
        Irq::DeadMan.unmask();
        Self {
            counts: u32::try_from(counts).unwrap_or(u32::MAX),
        }
    }

    /// Restarts the period.
    pub fn clear(&mut self) {
        LOAD.write(self.counts);
        CONTROL.write(ONE_SHOT);
    }

    /// Whether the timer has expired since the last [`DeadMan::acknowledge`]: the pins are safe, and stay so.
    pub fn has_expired(&self) -> bool {
        has_expired()
    }

    /// Lets the pins show a valid label again. To be called in the safe state.
    pub fn acknowledge(&mut self) {
        EXPIRED.store(false, Ordering::Relaxed);
    }
}

/// See [`DeadMan::has_expired`].
pub fn has_expired() -> bool {
    EXPIRED.load(Ordering::Relaxed)
}

/// The interrupt handler.
pub fn on_expired() {
    CLEAR_INTERRUPT.write(1);
    EXPIRED.store(true, Ordering::Relaxed);
    Pins(()).set(PinState {
        status: PinState::SAFE.status,
        ..pin_state::current()
    });
}
