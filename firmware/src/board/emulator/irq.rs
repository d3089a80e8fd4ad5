//! The interrupts that this program uses.

use cortex_m::{interrupt::InterruptNumber, peripheral::NVIC};

/// An interrupt of the board, by its number (Arm DAI 0386, table of interrupts).
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Irq {
    /// UART1 has received a byte from the Bluetooth controller.
    HciReceive = 2,
    /// TIMER1 has reached zero.
    Alarm = 9,
    /// No peripheral's: only a fault that is injected pends it.
    Storm = 31,
}

impl Irq {
    /// Enables it.
    #[expect(
        unsafe_code,
        reason = "the NVIC cannot know of critical sections that mask single interrupts"
    )]
    pub fn unmask(self) {
        // SAFETY: no critical section of this program masks single interrupts, so none is broken.
        unsafe { NVIC::unmask(self) };
    }
}

#[expect(unsafe_code, reason = "the trait is an unsafe one")]
// SAFETY: `number` returns the discriminant, and all are interrupt numbers of the board that never
// change.
unsafe impl InterruptNumber for Irq {
    fn number(self) -> u16 {
        self as u16
    }
}
