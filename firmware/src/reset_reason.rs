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
    /// The program itself, after the stack had grown too deep.
    StackOverflow,
}

impl ResetReason {
    /// Name on the UART.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Power => "power or reset",
            Self::Watchdog => "the watchdog",
            Self::Software => "software",
            Self::StackOverflow => "a stack overflow",
        }
    }
}

#[cfg(target_os = "none")]
pub use kept::{End, keep_end, previous_end};

#[cfg(target_os = "none")]
mod kept {
    use core::sync::atomic::{AtomicU32, Ordering};

    /// End of a run of the program.
    #[derive(Clone, Copy, PartialEq, Eq)]
    pub enum End {
        /// Unknown: power was lost.
        Unknown,
        /// A reset from outside while it ran.
        Running,
        /// A panic.
        Panic,
        /// A stack overflow.
        StackOverflow,
    }

    /// End of the previous run: kept over a reset.
    #[expect(
        unsafe_code,
        reason = "only the linker can exclude memory from being cleared"
    )]
    // SAFETY: cortex-m-rt places sections `.uninit.*` in RAM, as NOLOAD, and its start-up code does not
    // write them, so the initial value never arrives: every one of the 2^32 values that memory may hold
    // is a valid `AtomicU32`, and `previous_end` treats those that are none of the constants below as unknown.
    #[unsafe(link_section = ".uninit.LAST_RUN")]
    static LAST_RUN: AtomicU32 = AtomicU32::new(0);
    const RUNNING: u32 = 0x5255_4e21;
    const PANICKED: u32 = 0x5041_4e21;
    const OVERFLOWED: u32 = 0x5354_4b21;

    /// The end of the previous run. To be called once, at the start.
    pub fn previous_end() -> End {
        match LAST_RUN.swap(RUNNING, Ordering::Relaxed) {
            RUNNING => End::Running,
            PANICKED => End::Panic,
            OVERFLOWED => End::StackOverflow,
            _ => End::Unknown,
        }
    }

    /// Keeps how this run ends, for the next start.
    pub fn keep_end(end: End) {
        let word = match end {
            End::Unknown => 0,
            End::Running => RUNNING,
            End::Panic => PANICKED,
            End::StackOverflow => OVERFLOWED,
        };
        LAST_RUN.store(word, Ordering::Relaxed);
    }
}
