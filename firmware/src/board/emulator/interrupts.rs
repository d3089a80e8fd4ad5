//! The interrupts of the board, and its vector table.

use cortex_m::{interrupt::InterruptNumber, peripheral::NVIC};

use super::{clock, hci};

/// An interrupt line that this program uses.
#[derive(Clone, Copy)]
#[repr(u16)]
pub enum Line {
    /// A byte from the Bluetooth controller.
    HciReceive = 2,
    /// TIMER1.
    Alarm = 9,
}

impl Line {
    /// Lets it interrupt.
    #[expect(
        unsafe_code,
        reason = "the NVIC cannot know of critical sections by mask"
    )]
    pub fn unmask(self) {
        // SAFETY: no critical section here is made by masking single lines.
        unsafe { NVIC::unmask(self) };
    }
}

#[expect(unsafe_code, reason = "the trait asks for a promise")]
// SAFETY: both numbers are lines of the board (Arm DAI 0386) and fixed.
unsafe impl InterruptNumber for Line {
    fn number(self) -> u16 {
        self as u16
    }
}

/// An entry of the vector table.
pub union Vector {
    handler: extern "C" fn(),
    unused: usize,
}

/// What `cortex-m-rt` puts behind the core's own vectors.
#[expect(unsafe_code, reason = "the linker must find it by name and place")]
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Vector; 32] = {
    let mut vectors = [const { Vector { unused: 0 } }; 32];
    vectors[Line::HciReceive as usize] = Vector {
        handler: hci_receive,
    };
    vectors[Line::Alarm as usize] = Vector { handler: alarm };
    vectors
};

extern "C" fn hci_receive() {
    hci::received();
}

extern "C" fn alarm() {
    clock::alarm();
}
