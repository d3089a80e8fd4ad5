//! The interrupts that this program uses.

use cortex_m::{interrupt::InterruptNumber, peripheral::NVIC};

/// An interrupt of the board, by its number (Arm DAI 0386, table of interrupts).
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Irq {
    /// UART0 has received a byte of a command.
    CommandReceive = 0,
    /// UART1 has received a byte from the Bluetooth controller.
    HciReceive = 2,
    /// TIMER1 has reached zero.
    Alarm = 9,
    /// The dual timer has reached zero.
    DeadMan = 10,
    /// Interrupt of no peripheral, never enabled: a task is to be polled ([`Executor`](super::Executor)).
    Woken = 30,
}

/// Priority of all interrupts but that of the dead-man timer, which interrupts them. It has 0, the highest.
const LOWER: u8 = 0x80;

/// Sets the priorities, and enables the interrupts that belong to no driver.
#[expect(
    unsafe_code,
    reason = "priorities may break a critical section that relies on them"
)]
pub fn start() {
    let mut peripherals = cortex_m::Peripherals::take();
    for irq in [Irq::CommandReceive, Irq::HciReceive, Irq::Alarm] {
        if let Some(peripherals) = &mut peripherals {
            // SAFETY: critical sections of this program mask all interrupts; none relies on priorities.
            unsafe { peripherals.NVIC.set_priority(irq, LOWER) };
        }
    }
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
