//! How deep the stack ever went: the start paints it, and what is no longer paint was used.

use core::{
    fmt::Write as _,
    sync::atomic::{AtomicU32, Ordering},
};

use super::uart::Uart;

/// What `cortex-m-rt` paints with (its feature `paint-stack`).
const PAINT: u32 = 0xcccc_cccc;

/// Writes the most that was ever used, where it grew since the last report.
pub fn report(mut uart: Uart) {
    static REPORTED: AtomicU32 = AtomicU32::new(0);
    let used = used();
    if REPORTED.fetch_max(used, Ordering::Relaxed) < used {
        let _ = writeln!(uart, "STACK {used}");
    }
}

#[expect(unsafe_code, reason = "the linker alone knows where the stack lies")]
fn used() -> u32 {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let top = (&raw const _stack_start).addr();
    let mut word = &raw const _stack_end;
    // SAFETY: both symbols are aligned ends of one region of memory, which `word` does not leave;
    // what lies there is plain words, and a word that the stack takes meanwhile only ends the loop.
    while word.addr() < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    u32::try_from(top - word.addr()).unwrap_or(u32::MAX)
}
