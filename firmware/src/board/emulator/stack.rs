//! The deepest stack: the start-up code fills it with a pattern, and words that differ were used.

use core::{
    fmt::Write as _,
    ptr,
    sync::atomic::{AtomicU32, Ordering},
};

use super::uart::Uart;

/// The pattern of `cortex-m-rt` with the feature `paint-stack`.
const PAINT: u32 = 0xcccc_cccc;

/// Writes the most bytes that were ever used, if more than in the last report.
pub fn report(mut uart: Uart) {
    static REPORTED: AtomicU32 = AtomicU32::new(0);
    let used = used();
    if REPORTED.fetch_max(used, Ordering::Relaxed) < used {
        critical_section::with(|_| {
            let _ = writeln!(uart, "STACK {used}");
        });
    }
}

#[expect(
    unsafe_code,
    reason = "only the linker script knows where the stack lies"
)]
fn used() -> u32 {
    // SAFETY: link.x of cortex-m-rt defines both symbols, as the ends of the stack. Only their
    // addresses are used.
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let top = (&raw const _stack_start).addr();
    let mut word = ptr::with_exposed_provenance::<u32>((&raw const _stack_end).addr());
    // SAFETY: both symbols are word-aligned ends of one region of RAM, and `word` stays inside it.
    // Every word of it was initialised by the start-up code. Below the stack pointer it belongs to
    // no Rust object, and the loop ends at the first word that was ever used; a frame that holds
    // nothing but the pattern is only read, and volatile.
    while word.addr() < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    u32::try_from(top - word.addr()).unwrap_or(u32::MAX)
}
