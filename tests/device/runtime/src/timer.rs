//! The count of executed instructions.
//!
//! With `-icount shift=6` QEMU advances its clock by 64 ns an instruction, independent of the host's
//! speed; at the timer's 25 MHz these are 1.6 ticks.

use core::ptr;

/// The first CMSDK timer of the mps2-an386.
const TIMER0: usize = 0x4000_0000;
const CONTROL: *mut u32 = TIMER0 as *mut u32;
/// Counts down, 32 bits: enough for 2.6 billion instructions.
const VALUE: *mut u32 = (TIMER0 + 4) as *mut u32;
const RELOAD: *mut u32 = (TIMER0 + 8) as *mut u32;
const ENABLE: u32 = 1;

/// Starts the timer from its largest value.
pub fn start() {
    #[expect(unsafe_code, reason = "registers of a peripheral")]
    // SAFETY: the addresses are aligned registers of a timer that the mps2-an386 has, in a region
    // that holds no memory of the program, and no other code uses this timer.
    unsafe {
        ptr::write_volatile(RELOAD, u32::MAX);
        ptr::write_volatile(VALUE, u32::MAX);
        ptr::write_volatile(CONTROL, ENABLE);
    }
}

/// A reading of the timer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Instant(u32);

/// Reads the timer, which takes some instructions itself.
#[inline(always)]
pub fn now() -> Instant {
    #[expect(unsafe_code, reason = "a register of a peripheral")]
    // SAFETY: as in `start`; reading the register has no side effect.
    Instant(unsafe { ptr::read_volatile(VALUE) })
}

impl Instant {
    /// Instructions since [`start`], rounded: a difference is exact to one instruction.
    pub fn instructions(self) -> u32 {
        // 1.6 ticks are 8/5; five times the count needs more than 32 bits.
        ((u64::from(u32::MAX - self.0) * 5 + 4) / 8) as u32
    }
}
