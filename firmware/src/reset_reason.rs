//! Why the program started, and what the run before said at its end.

#[derive(Clone, Copy, PartialEq, Eq)]
#[cfg_attr(not(target_os = "none"), derive(clap::ValueEnum))]
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

/// Most bytes that are kept of a message.
const MESSAGE_BYTES: usize = 120;

/// Message of the panic that ended the run before; empty if none did, and on a simulated board.
pub fn previous_message() -> heapless::String<MESSAGE_BYTES> {
    #[cfg(target_os = "none")]
    return kept::previous_message();
    #[cfg(not(target_os = "none"))]
    return heapless::String::new();
}

#[cfg(target_os = "none")]
pub use kept::{End, keep_end, previous_end};

#[cfg(target_os = "none")]
mod kept {
    use core::fmt::{self, Write as _};
    use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

    use super::MESSAGE_BYTES;

    /// End of a run of the program.
    #[derive(Clone, Copy, PartialEq, Eq)]
    pub enum End {
        /// Unknown: power was lost.
        Unknown,
        /// A reset from outside while it ran.
        Running,
        Panic,
        StackOverflow,
    }

    /// End of the previous run: kept over a reset.
    #[expect(
        unsafe_code,
        reason = "only the linker can exclude memory from being cleared"
    )]
    // SAFETY: memory.x places sections `.kept.*` in RAM, as NOLOAD, and the start-up code does not
    // write them, so the initial value never arrives: every one of the 2^32 values that memory may hold
    // is a valid `AtomicU32`, and `previous_end` treats values other than the constants below as unknown.
    #[unsafe(link_section = ".kept.LAST_RUN")]
    static LAST_RUN: AtomicU32 = AtomicU32::new(0);
    const RUNNING: u32 = 0x5255_4e21;
    const PANICKED: u32 = 0x5041_4e21;
    const OVERFLOWED: u32 = 0x5354_4b21;

    /// Message of the panic that ended the previous run, up to a 0: kept over a reset.
    #[expect(
        unsafe_code,
        reason = "only the linker can exclude memory from being cleared"
    )]
    // SAFETY: as above: every value of a byte is a valid `AtomicU8`, and `previous_end` empties the message unless a panic
    // has written it.
    #[unsafe(link_section = ".kept.LAST_MESSAGE")]
    static LAST_MESSAGE: [AtomicU8; MESSAGE_BYTES] = [const { AtomicU8::new(0) }; MESSAGE_BYTES];

    /// The end of the previous run. To be called once, at the start.
    pub fn previous_end() -> End {
        let end = match LAST_RUN.swap(RUNNING, Ordering::Relaxed) {
            RUNNING => End::Running,
            PANICKED => End::Panic,
            OVERFLOWED => End::StackOverflow,
            _ => End::Unknown,
        };
        if end != End::Panic {
            LAST_MESSAGE[0].store(0, Ordering::Relaxed);
        }
        end
    }

    pub fn previous_message() -> heapless::String<MESSAGE_BYTES> {
        let bytes = LAST_MESSAGE.iter().map(|byte| byte.load(Ordering::Relaxed));
        let mut message = heapless::String::new();
        for byte in bytes.take_while(|byte| *byte != 0) {
            // Of RAM that was just powered any byte may come, and a character of two bytes.
            let _ = message.push(if byte.is_ascii() { byte.into() } else { ' ' });
        }
        message
    }

    /// Writes into [`LAST_MESSAGE`], from this byte on, what is printable; the rest as spaces.
    struct Keeper(usize);

    impl fmt::Write for Keeper {
        fn write_str(&mut self, text: &str) -> fmt::Result {
            for byte in text.bytes() {
                let kept = LAST_MESSAGE.get(self.0).ok_or(fmt::Error)?;
                let is_printable = byte.is_ascii_graphic();
                kept.store(if is_printable { byte } else { b' ' }, Ordering::Relaxed);
                self.0 += 1;
            }
            Ok(())
        }
    }

    /// Keeps how this run ends, and the beginning of a panic's message, for the next start.
    pub fn keep_end(end: End, message: &dyn fmt::Display) {
        let mut keeper = Keeper(0);
        // An error: there is no room for all of it.
        let _ = write!(keeper, "{message}");
        if let Some(rest) = LAST_MESSAGE.get(keeper.0) {
            rest.store(0, Ordering::Relaxed);
        }
        let word = match end {
            End::Unknown => 0,
            End::Running => RUNNING,
            End::Panic => PANICKED,
            End::StackOverflow => OVERFLOWED,
        };
        LAST_RUN.store(word, Ordering::Relaxed);
    }
}
